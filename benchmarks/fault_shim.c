/* Faults of one process's disk and clock, for LD_PRELOAD.

   The file $SEAGLINT_FAULT_TABLE is mapped as rows (process, delay, error, clock). A call of a process with a row, or of any process for a
   row with process -1, that opens, writes, renames or removes something below $SEAGLINT_FAULT_FOLDER waits for `delay` milliseconds (-1:
   until the row changes) and then fails with `error`, if that is not 0. Its clock is ahead by `clock` seconds; the monotonic clock stays
   right, as on a machine whose date is wrong. The delay of reads is left out: nothing is replaced by a read. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum { ROWS = 64 };

struct row {
    int32_t process, delay_ms, error, clock_s;
};

static volatile struct row *table;
static const char *folder;

__attribute__((constructor)) static void map_table(void) {
    const char *path = getenv("SEAGLINT_FAULT_TABLE");
    folder = getenv("SEAGLINT_FAULT_FOLDER");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0)
        return;
    void *there = mmap(NULL, ROWS * sizeof(struct row), PROT_READ, MAP_SHARED, file, 0);
    table = there == MAP_FAILED ? NULL : there;
    close(file);
}

static volatile struct row *own_row(void) {
    int32_t own = getpid();
    for (int i = 0; table && i < ROWS; i++)
        if (table[i].process == own || table[i].process == -1)
            return &table[i];
    return NULL;
}

static int below(const char *path) {
    return path && folder && strncmp(path, folder, strlen(folder)) == 0;
}

static int opened_below(int file) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t size = readlink(link, path, sizeof path - 1);
    if (size < 0)
        return 0;
    path[size] = 0;
    return below(path);
}

/* Wait, and return the error of the call; 0 where it goes through. */
static int disturbed(void) {
    volatile struct row *row = own_row();
    int waited = 0, own = getpid();
    while (row && (row->process == own || row->process == -1) && (row->delay_ms < 0 || waited < row->delay_ms)) {
        usleep(10000);
        waited += 10;
    }
    return row ? row->error : 0;
}

#define REAL(name) static __typeof__(&name) real; if (!real) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)
#define FAIL_IF(applies)                      \
    if (own_row() && (applies)) {             \
        int error = disturbed();              \
        if (error) { errno = error; return -1; } \
    }
#define MODE(flags, last) \
    mode_t mode = 0;      \
    if ((flags) & (O_CREAT | O_TMPFILE)) { va_list more; va_start(more, last); mode = va_arg(more, mode_t); va_end(more); }

int open(const char *path, int flags, ...) {
    REAL(open); MODE(flags, flags)
    FAIL_IF((flags & (O_WRONLY | O_RDWR)) && below(path))
    return real(path, flags, mode);
}
int open64(const char *path, int flags, ...) {
    REAL(open64); MODE(flags, flags)
    FAIL_IF((flags & (O_WRONLY | O_RDWR)) && below(path))
    return real(path, flags, mode);
}
int openat(int at, const char *path, int flags, ...) {
    REAL(openat); MODE(flags, flags)
    FAIL_IF((flags & (O_WRONLY | O_RDWR)) && below(path))
    return real(at, path, flags, mode);
}
int openat64(int at, const char *path, int flags, ...) {
    REAL(openat64); MODE(flags, flags)
    FAIL_IF((flags & (O_WRONLY | O_RDWR)) && below(path))
    return real(at, path, flags, mode);
}
ssize_t write(int file, const void *data, size_t size) {
    REAL(write);
    FAIL_IF(opened_below(file))
    return real(file, data, size);
}
int fsync(int file) {
    REAL(fsync);
    FAIL_IF(opened_below(file))
    return real(file);
}
int rename(const char *from, const char *to) {
    REAL(rename);
    FAIL_IF(below(to))
    return real(from, to);
}
int renameat(int from_at, const char *from, int to_at, const char *to) {
    REAL(renameat);
    FAIL_IF(below(to))
    return real(from_at, from, to_at, to);
}
int unlink(const char *path) {
    REAL(unlink);
    FAIL_IF(below(path))
    return real(path);
}
int mkdir(const char *path, mode_t mode) {
    REAL(mkdir);
    FAIL_IF(below(path))
    return real(path, mode);
}

static int ahead(void) {
    volatile struct row *row = own_row();
    return row ? row->clock_s : 0;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    REAL(clock_gettime);
    int result = real(clock, now);
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        now->tv_sec += ahead();
    return result;
}
int gettimeofday(struct timeval *now, void *zone) {
    REAL(gettimeofday);
    int result = real(now, zone);
    if (result == 0)
        now->tv_sec += ahead();
    return result;
}
time_t time(time_t *out) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (out)
        *out = now.tv_sec;
    return now.tv_sec;
}
