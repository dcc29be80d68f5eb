#include "realtime_guard.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>

// From linux/prctl.h, which older headers lack.
#ifndef PR_SET_SYSCALL_USER_DISPATCH
#define PR_SET_SYSCALL_USER_DISPATCH 59
#define PR_SYS_DISPATCH_OFF 0
#define PR_SYS_DISPATCH_ON 1
#endif

namespace {

thread_local bool guarded = false;
// Read by the kernel at every system call of the thread that gave it: 0 lets it pass, 1 turns it into a SIGSYS.
thread_local volatile char system_calls = 0;

[[noreturn]] void end(const char* what) {
  guarded = false;
  system_calls = 0;
  constexpr char rest[] = " in a real-time step\n";
  // Nothing can be done about a standard error that is closed.
  if (write(STDERR_FILENO, what, std::strlen(what)) < 0 || write(STDERR_FILENO, rest, sizeof rest - 1) < 0)
    std::abort();
  std::abort();
}

void refuse(const char* what) {
  if (guarded) end(what);
}

void on_system_call(int) { end("system call"); }

template <class Function>
Function original(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  Function function = nullptr;
  static_assert(sizeof function == sizeof found);
  std::memcpy(&function, &found, sizeof found);
  return function;
}

}  // namespace

// What is defined here takes the place of the C library's for the whole program, the C++ runtime included: operator new
// ends in malloc, an exception in malloc as well, and std::mutex in pthread_mutex_lock.
extern "C" {

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static const auto lock = original<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  refuse("lock");
  return lock(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
  static const auto read_lock = original<int (*)(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
  refuse("lock");
  return read_lock(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
  static const auto write_lock = original<int (*)(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
  refuse("lock");
  return write_lock(lock);
}

// glibc's own entry points under other names.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  refuse("heap allocation");
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  refuse("heap allocation");
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  refuse("heap allocation");
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  refuse("heap allocation");
  return __libc_memalign(alignment, size);
}
void free(void* memory) {
  if (memory != nullptr) refuse("release of heap memory");
  __libc_free(memory);
}
}

namespace breakaway::testing {
namespace {

// Once a thread and process: a child of fork() begins without it.
bool watch_system_calls() noexcept {
#ifdef __x86_64__
  static thread_local pid_t watched = 0;
  if (watched == getpid()) return true;
  if (std::signal(SIGSYS, on_system_call) == SIG_ERR) return false;
  if (prctl(PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_ON, 0, 0, &system_calls) != 0) return false;
  watched = getpid();
  return true;
#else
  static_cast<void>(on_system_call);
  return false;
#endif
}

}  // namespace

RealtimeGuard::RealtimeGuard() noexcept {
  const bool watched = watch_system_calls();
  guarded = true;
  system_calls = watched ? 1 : 0;
}

RealtimeGuard::~RealtimeGuard() noexcept {
  system_calls = 0;
  guarded = false;
}

RealtimePause::RealtimePause() noexcept : guarded_{guarded}, system_calls_{system_calls} {
  system_calls = 0;
  guarded = false;
}

RealtimePause::~RealtimePause() noexcept {
  guarded = guarded_;
  system_calls = system_calls_;
}

bool RealtimeGuard::sees_system_calls() noexcept { return watch_system_calls(); }

}  // namespace breakaway::testing
