"""Files that the program reads and writes: tables, arrays, whole or not at all."""
