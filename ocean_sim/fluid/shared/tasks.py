"""How a kernel makes a task of each group of cells or particles.

Taichi hands out a parallel loop in tasks of no fewer than TASK iterations. Groups are few, 16 or 64, and each is long,
so a plain loop over them would be one task, and run on one thread. Therefore a loop runs over TASK times the groups and
every TASK-th iteration does the work of one:

    for g in range(groups * TASK):
        if g % TASK == 0:
            work(g // TASK)

Each group is then a task of its own that threads take in turn, and one thread alone writes to the scratch and the sums
of a group, so results depend neither on the number of threads nor on their order.
"""

TASK = 512
