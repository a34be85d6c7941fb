/* Between a program and the system: the nth write, fsync or rename below a folder fails, or the process is killed before
   it. Built by test_faults.py and loaded with LD_PRELOAD; armed by whoever calls `arm`. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

enum { COUNT, FAIL, FULL, KILL };

static char below[4096];
static int mode, at, seen;

int arm(const char *folder, int how, int nth) {
    strncpy(below, folder, sizeof below - 1);
    mode = how, at = nth, seen = 0;
    return 0;
}

int calls(void) { return seen; }

static int named(const char *path) { return below[0] && path && strncmp(path, below, strlen(below)) == 0; }

static int opened(int file) {
    char link[64], path[4096];
    if (!below[0]) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t n = readlink(link, path, sizeof path - 1);
    if (n <= 0) return 0;
    path[n] = 0;
    return named(path);
}

static int strikes(int concerned) { /* whether this call is the one */
    if (!concerned) return 0;
    seen++;
    if (mode == KILL && seen == at) kill(getpid(), SIGKILL);
    return (mode == FAIL && seen == at) || (mode == FULL && seen >= at);
}

ssize_t write(int file, const void *data, size_t size) {
    ssize_t (*real)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
    if (strikes(opened(file))) {
        if (size > 1) real(file, data, size / 2); /* as a disk does that runs full */
        errno = ENOSPC;
        return -1;
    }
    return real(file, data, size);
}

int fsync(int file) {
    int (*real)(int) = dlsym(RTLD_NEXT, "fsync");
    if (strikes(opened(file))) {
        errno = EIO;
        return -1;
    }
    return real(file);
}

int rename(const char *from, const char *to) {
    int (*real)(const char *, const char *) = dlsym(RTLD_NEXT, "rename");
    int how = mode == COUNT ? at : mode; /* a count is of what goes wrong in a mode, and on a full disk a name still fits */
    if (how != FULL && strikes(named(to))) {
        errno = EIO;
        return -1;
    }
    return real(from, to);
}
