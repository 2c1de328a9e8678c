// SPDX-License-Identifier: MIT
// Preloaded into a program: the n-th call of one function fails, as it may on any machine.
//   CUBOCT_FAIL_CALL  group of calls: open, write, rename, sync, truncate, mmap, fork, thread, memory, directory, read, clock
//   CUBOCT_FAIL_AT    which of them, from 1; 0: none. Of readings of the wall clock all from there on: a day ahead, a day behind, ...
//   CUBOCT_FAIL_IN    the program, by the name of its file; its children of other names are spared
//   CUBOCT_FAIL_RANK  of ranks: in this one alone
//   CUBOCT_FAIL_KILLS set: the program is killed there instead; or, by its number, another process, and the call goes on
//   CUBOCT_FAIL_MARK  file that the failing call makes: the function's name, and from where in the program it was called, or 0
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum Group { Open, Write, Rename, Sync, Truncate, Map, Fork, Thread, Memory, Directory, Read, Wall, None };
static const char* const kNames[] = {"open", "write",  "rename", "sync",      "truncate", "mmap",
                                     "fork", "thread", "memory", "directory", "read",     "clock"};

static enum Group wanted = None;
static long at;
static atomic_long count;
static atomic_int armed;
static const char* mark;
static const char* kills;

static void leave_mark(const char* function, const void* caller) {
  if (mark == NULL) return;
  Dl_info of;
  const int known = dladdr(caller, &of) != 0 && strstr(of.dli_fname, ".so") == NULL;
  char text[80];
  const int size = snprintf(text, sizeof text, "%s %lx", function, known ? (long)((const char*)caller - (const char*)of.dli_fbase) : 0L);
  const long file = syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0) return;
  syscall(SYS_write, file, text, size);
  syscall(SYS_close, file);
}

static int fails_at(enum Group group, const char* function, int error, const void* caller) {
  if (group != wanted || !atomic_load_explicit(&armed, memory_order_relaxed)) return 0;
  if (atomic_fetch_add(&count, 1) + 1 != at) return 0;
  leave_mark(function, caller);
  if (kills != NULL) {
    syscall(SYS_kill, *kills == 0 ? getpid() : (pid_t)atol(kills), SIGKILL);
    return 0;
  }
  errno = error;
  return 1;
}

#define fails(group, function, error) fails_at(group, function, error, __builtin_return_address(0))

// What runs before main is the system's own.
static int (*real_main)(int, char**, char**);
static int wrapped_main(int argc, char** argv, char** environment) {
  const char* const call = getenv("CUBOCT_FAIL_CALL");
  const char* const in = getenv("CUBOCT_FAIL_IN");
  const char* const number = getenv("CUBOCT_FAIL_AT");
  const char *const rank = getenv("CUBOCT_FAIL_RANK"), *const here = getenv("OMPI_COMM_WORLD_RANK");
  const int mine = rank == NULL || (here != NULL && strcmp(rank, here) == 0);
  mark = getenv("CUBOCT_FAIL_MARK");
  kills = getenv("CUBOCT_FAIL_KILLS");
  if (call != NULL && number != NULL && mine && (in == NULL || strcmp(in, program_invocation_short_name) == 0)) {
    for (int k = 0; k < None; ++k)
      if (strcmp(call, kNames[k]) == 0) wanted = (enum Group)k;
    at = atol(number);
    atomic_store(&armed, 1);
  }
  return real_main(argc, argv, environment);
}

typedef int Main(int, char**, char**);
int __libc_start_main(Main* main, int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end) {
  int (*next)(Main*, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);
  *(void**)&next = dlsym(RTLD_NEXT, "__libc_start_main");
  real_main = main;
  return next(wrapped_main, argc, argv, init, fini, rtld_fini, stack_end);
}

// `name` with the arguments in parentheses, after it was looked up once.
#define NEXT(result, name, ...)                                                 \
  static result (*next)(__VA_ARGS__);                                           \
  if (next == NULL) *(void**)&next = dlsym(RTLD_NEXT, #name)

#define OPENS(name)                                       \
  int name(const char* path, int flags, ...) {            \
    NEXT(int, name, const char*, int, ...);               \
    va_list list;                                         \
    va_start(list, flags);                                \
    const mode_t mode = (mode_t)va_arg(list, int);        \
    va_end(list);                                         \
    return fails(Open, #name, EMFILE) ? -1 : next(path, flags, mode); \
  }
OPENS(open)
OPENS(open64)

#define OPENS_AT(name)                                    \
  int name(int directory, const char* path, int flags, ...) { \
    NEXT(int, name, int, const char*, int, ...);          \
    va_list list;                                         \
    va_start(list, flags);                                \
    const mode_t mode = (mode_t)va_arg(list, int);        \
    va_end(list);                                         \
    return fails(Open, #name, EMFILE) ? -1 : next(directory, path, flags, mode); \
  }
OPENS_AT(openat)
OPENS_AT(openat64)

// A call that takes these and returns `wrong` where it fails.
#define FAILS(group, result, wrong, error, name, declared, types, given) \
  result name declared {                                                 \
    NEXT(result, name, types);                                           \
    return fails(group, #name, error) ? wrong : next given;              \
  }
#define TYPES(...) __VA_ARGS__

FAILS(Open, FILE*, NULL, EMFILE, fopen, (const char* path, const char* mode), TYPES(const char*, const char*), (path, mode))
FAILS(Open, FILE*, NULL, EMFILE, fopen64, (const char* path, const char* mode), TYPES(const char*, const char*), (path, mode))
FAILS(Directory, DIR*, NULL, EMFILE, opendir, (const char* path), TYPES(const char*), (path))
FAILS(Directory, int, -1, EACCES, mkdir, (const char* path, mode_t mode), TYPES(const char*, mode_t), (path, mode))
FAILS(Directory, int, -1, EACCES, unlink, (const char* path), TYPES(const char*), (path))
FAILS(Directory, int, -1, EACCES, remove, (const char* path), TYPES(const char*), (path))
FAILS(Rename, int, -1, EIO, rename, (const char* from, const char* to), TYPES(const char*, const char*), (from, to))
FAILS(Sync, int, -1, EIO, fsync, (int file), TYPES(int), (file))
FAILS(Sync, int, -1, EIO, fdatasync, (int file), TYPES(int), (file))
FAILS(Truncate, int, -1, EIO, ftruncate, (int file, off_t size), TYPES(int, off_t), (file, size))
FAILS(Truncate, int, -1, EIO, ftruncate64, (int file, off64_t size), TYPES(int, off64_t), (file, size))
FAILS(Map, void*, MAP_FAILED, ENOMEM, mmap, (void* to, size_t size, int may, int flags, int file, off_t from),
      TYPES(void*, size_t, int, int, int, off_t), (to, size, may, flags, file, from))
FAILS(Map, void*, MAP_FAILED, ENOMEM, mmap64, (void* to, size_t size, int may, int flags, int file, off64_t from),
      TYPES(void*, size_t, int, int, int, off64_t), (to, size, may, flags, file, from))
FAILS(Fork, pid_t, -1, EAGAIN, fork, (void), TYPES(void), ())
FAILS(Thread, int, EAGAIN, EAGAIN, pthread_create,
      (pthread_t * thread, const pthread_attr_t* how, void* (*start)(void*), void* with),
      TYPES(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*), (thread, how, start, with))
FAILS(Fork, int, EAGAIN, EAGAIN, posix_spawn,
      (pid_t * child, const char* path, const posix_spawn_file_actions_t* files, const posix_spawnattr_t* how, char* const* words,
       char* const* environment),
      TYPES(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*, char* const*, char* const*),
      (child, path, files, how, words, environment))
FAILS(Read, ssize_t, -1, EIO, read, (int file, void* to, size_t size), TYPES(int, void*, size_t), (file, to, size))
FAILS(Read, ssize_t, -1, EIO, pread, (int file, void* to, size_t size, off_t from), TYPES(int, void*, size_t, off_t), (file, to, size, from))
FAILS(Read, ssize_t, -1, EIO, pread64, (int file, void* to, size_t size, off64_t from), TYPES(int, void*, size_t, off64_t),
      (file, to, size, from))

// Standard streams are spared: what they cannot take has tests of its own.
#define WRITES(file, name) ((file) > 2 && fails(Write, name, ENOSPC))
ssize_t write(int file, const void* from, size_t size) {
  NEXT(ssize_t, write, int, const void*, size_t);
  return WRITES(file, "write") ? -1 : next(file, from, size);
}
ssize_t pwrite(int file, const void* from, size_t size, off_t to) {
  NEXT(ssize_t, pwrite, int, const void*, size_t, off_t);
  return WRITES(file, "pwrite") ? -1 : next(file, from, size, to);
}
ssize_t pwrite64(int file, const void* from, size_t size, off64_t to) {
  NEXT(ssize_t, pwrite64, int, const void*, size_t, off64_t);
  return WRITES(file, "pwrite64") ? -1 : next(file, from, size, to);
}
ssize_t writev(int file, const struct iovec* from, int parts) {
  NEXT(ssize_t, writev, int, const struct iovec*, int);
  return WRITES(file, "writev") ? -1 : next(file, from, parts);
}
size_t fwrite(const void* from, size_t size, size_t items, FILE* to) {
  NEXT(size_t, fwrite, const void*, size_t, size_t, FILE*);
  return WRITES(fileno(to), "fwrite") ? 0 : next(from, size, items, to);
}
int fclose(FILE* file) {
  NEXT(int, fclose, FILE*);
  if (!WRITES(fileno(file), "fclose")) return next(file);
  next(file);
  errno = ENOSPC;
  return EOF;
}

// Seconds by which the wall clock is wrong now.
static time_t jump(const char* function) {
  static const time_t kDay = 86400;
  if (wanted != Wall || !atomic_load_explicit(&armed, memory_order_relaxed)) return 0;
  const long n = atomic_fetch_add(&count, 1) + 1;
  if (n == at) leave_mark(function, NULL);
  return n < at ? 0 : (n - at) % 2 == 0 ? kDay : -kDay;
}
int clock_gettime(clockid_t clock, struct timespec* now) {
  NEXT(int, clock_gettime, clockid_t, struct timespec*);
  const int code = next(clock, now);
  if (code == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += jump("clock_gettime");
  return code;
}
int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  NEXT(int, gettimeofday, struct timeval*, void*);
  const int code = next(now, zone);
  if (code == 0) now->tv_sec += jump("gettimeofday");
  return code;
}
time_t time(time_t* to) {
  NEXT(time_t, time, time_t*);
  const time_t now = next(NULL) + jump("time");
  if (to != NULL) *to = now;
  return now;
}

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t size) { return fails(Memory, "malloc", ENOMEM) ? NULL : __libc_malloc(size); }
void* calloc(size_t items, size_t size) { return fails(Memory, "calloc", ENOMEM) ? NULL : __libc_calloc(items, size); }
void* realloc(void* old, size_t size) { return fails(Memory, "realloc", ENOMEM) ? NULL : __libc_realloc(old, size); }
void* memalign(size_t align, size_t size) { return fails(Memory, "memalign", ENOMEM) ? NULL : __libc_memalign(align, size); }
void* aligned_alloc(size_t align, size_t size) { return fails(Memory, "aligned_alloc", ENOMEM) ? NULL : __libc_memalign(align, size); }
int posix_memalign(void** to, size_t align, size_t size) {
  if (fails(Memory, "posix_memalign", ENOMEM)) return ENOMEM;
  *to = __libc_memalign(align, size);
  return *to == NULL ? ENOMEM : 0;
}
