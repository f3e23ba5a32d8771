/* Preloaded into the program: the n-th call that writes below a folder fails, or a signal comes before it. Counted are
 * writes, syncs, renames and files that are opened to be written, whose path holds BURNISH_FAULT_FOLDER.
 *
 *   BURNISH_FAULT_NUMBER   n, from 1
 *   BURNISH_FAULT_ERROR    the errno; 0: a write of half of the bytes, which says so; -1: the program is killed, in a
 *                          write after half of the bytes
 *   BURNISH_FAULT_SIGNAL   in place of an error: a signal that comes before the n-th call, which waits for 0.3 s
 *   BURNISH_FAULT_ALWAYS   set: and all calls after it
 *   BURNISH_FAULT_MEMORY_AFTER  so many checkpoints: then memory ends once, for an allocation of 64 KiB or
 *                          more: images, not the buffers of the system's library
 *   BURNISH_FAULT_LOCK     the errno of every flock
 *   BURNISH_FAULT_FOLDER_SYNC  the errno of every fsync of a folder
 *   BURNISH_FAULT_NFS      set: files named "lock" that are removed while they are open stay, as .nfs0001, until they
 *                          are closed
 *   BURNISH_FAULT_THREADS  set: no thread is begun
 *   BURNISH_FAULT_LOG      a file that is made when the n-th call comes
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_int calls;

/* After so many renames of checkpoints the next allocation that is large fails. */
extern void* __libc_malloc(size_t size);
static atomic_int checkpoints;

static int is_last_checkpoint(void) {
    const char* after = getenv("BURNISH_FAULT_MEMORY_AFTER");
    return after && atomic_load(&checkpoints) == atoi(after);
}

void* malloc(size_t size) {
    static atomic_int failed;
    if (size >= 65536 && is_last_checkpoint() && !atomic_exchange(&failed, 1)) {
        errno = ENOMEM;
        return NULL;
    }
    return __libc_malloc(size);
}

static int is_watched(const char* path) {
    const char* folder = getenv("BURNISH_FAULT_FOLDER");
    return folder && path && strstr(path, folder) != NULL;
}

static int is_watched_descriptor(int descriptor) {
    char name[64], path[PATH_MAX + 1];
    snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
    const ssize_t size = readlink(name, path, PATH_MAX);
    if (size < 0) return 0;
    path[size] = '\0';
    return is_watched(path);
}

/* Whether this call is one that fails. */
static int fails(void) {
    const char* number = getenv("BURNISH_FAULT_NUMBER");
    if (!number) return 0;
    const int call = atomic_fetch_add(&calls, 1) + 1;
    const int hit = getenv("BURNISH_FAULT_ALWAYS") ? call >= atoi(number) : call == atoi(number);
    if (!hit) return 0;
    const char* log = getenv("BURNISH_FAULT_LOG");
    if (log) {
        const long file = syscall(SYS_openat, AT_FDCWD, log, O_CREAT | O_WRONLY, 0600);
        if (file >= 0) syscall(SYS_close, file);
    }
    const char* comes = getenv("BURNISH_FAULT_SIGNAL");
    if (!comes) return 1;
    kill(getpid(), atoi(comes));
    usleep(300000);
    return 0;
}

static int error_number(void) { return atoi(getenv("BURNISH_FAULT_ERROR")); }

static int fail(void) {
    if (error_number() < 0) kill(getpid(), SIGKILL);
    errno = error_number() ? error_number() : EIO;
    return -1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int descriptor, const void* bytes, size_t size) {
    if (is_watched_descriptor(descriptor) && fails()) {
        if (error_number() > 0) return fail();
        size = (size + 1) / 2;
        if (error_number() < 0) REAL(write)(descriptor, bytes, size), fail();
    }
    return REAL(write)(descriptor, bytes, size);
}

ssize_t writev(int descriptor, const struct iovec* parts, int count) {
    if (is_watched_descriptor(descriptor) && fails() && error_number()) return fail();
    return REAL(writev)(descriptor, parts, count);
}

ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t at) {
    if (is_watched_descriptor(descriptor) && fails()) {
        if (error_number() > 0) return fail();
        size = (size + 1) / 2;
        if (error_number() < 0) REAL(pwrite)(descriptor, bytes, size, at), fail();
    }
    return REAL(pwrite)(descriptor, bytes, size, at);
}

ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off64_t at) {
    return pwrite(descriptor, bytes, size, at);
}

/* Fails with the errno that the environment says. */
static int fail_with(const char* error) {
    errno = atoi(error);
    return -1;
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) {
    if (getenv("BURNISH_FAULT_THREADS")) return EAGAIN;
    return REAL(pthread_create)(thread, attributes, run, argument);
}

int flock(int descriptor, int operation) {
    const char* error = getenv("BURNISH_FAULT_LOCK");
    return error ? fail_with(error) : REAL(flock)(descriptor, operation);
}

int fsync(int descriptor) {
    const char* error = getenv("BURNISH_FAULT_FOLDER_SYNC");
    struct stat status;
    if (error && fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode)) return fail_with(error);
    if (is_watched_descriptor(descriptor) && fails()) return fail();
    return REAL(fsync)(descriptor);
}

static const char* const kStays = ".nfs0001";

static int ends_with(const char* text, const char* end) {
    const size_t length = strlen(text), size = strlen(end);
    return length >= size && strcmp(text + length - size, end) == 0;
}

int unlinkat(int folder, const char* path, int flags) {
    if (getenv("BURNISH_FAULT_NFS") && ends_with(path, kStays)) {
        errno = EBUSY;
        return -1;
    }
    if (getenv("BURNISH_FAULT_NFS") && ends_with(path, "lock")) {
        char other[PATH_MAX + 16];
        snprintf(other, sizeof other, "%.*s%s", (int)(strlen(path) - strlen("lock")), path, kStays);
        return renameat(folder, path, folder, other);
    }
    return REAL(unlinkat)(folder, path, flags);
}

int remove(const char* path) {
    const int stays = ends_with(path, kStays) || ends_with(path, "lock");
    return getenv("BURNISH_FAULT_NFS") && stays ? unlinkat(AT_FDCWD, path, 0) : REAL(remove)(path);
}

int close(int descriptor) {
    char name[64], path[PATH_MAX + 1];
    ssize_t size = -1;
    if (getenv("BURNISH_FAULT_NFS")) {
        snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
        size = readlink(name, path, PATH_MAX);
    }
    const int result = REAL(close)(descriptor);
    if (size < 0) return result;
    path[size] = '\0';
    if (ends_with(path, kStays)) syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    return result;
}

int rename(const char* from, const char* to) {
    const size_t length = strlen(to), end = strlen(".burnish");
    if (length > end && strcmp(to + length - end, ".burnish") == 0) atomic_fetch_add(&checkpoints, 1);
    if (is_watched(to) && fails()) return fail();
    return REAL(rename)(from, to);
}

int mkdir(const char* path, mode_t mode) {
    if (is_watched(path) && fails()) return fail();
    return REAL(mkdir)(path, mode);
}

int fallocate(int descriptor, int mode, off_t from, off_t size) {
    if (is_watched_descriptor(descriptor) && fails()) return fail();
    return REAL(fallocate)(descriptor, mode, from, size);
}

int fallocate64(int descriptor, int mode, off64_t from, off64_t size) {
    return fallocate(descriptor, mode, from, size);
}

static int opens_to_write(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    if (opens_to_write(flags) && is_watched(path) && fails()) return fail();
    return REAL(open)(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open(path, flags, mode);
}
