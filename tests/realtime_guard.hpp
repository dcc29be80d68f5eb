// RealtimeGuard: while one lives, its thread may not call what can wait: the heap, a lock, the system.
//
// A program that uses it is linked with realtime_guard.cpp, which puts itself before the C library: whatever the step
// under test calls, however deep, ends there. A call that is forbidden ends the program with its name. It does
// not go with the address sanitizer, which must put itself there.
#pragma once

namespace breakaway::testing {

class RealtimeGuard {
 public:
  RealtimeGuard() noexcept;
  ~RealtimeGuard() noexcept;
  RealtimeGuard(const RealtimeGuard&) = delete;
  RealtimeGuard& operator=(const RealtimeGuard&) = delete;

  // Whether this machine can see system calls (Linux 5.11 and later on x86).
  static bool sees_system_calls() noexcept;
};

// While one lives, its thread may do again what it could before the guard: for a test's own port or drive, which a step
// calls.
class RealtimePause {
 public:
  RealtimePause() noexcept;
  ~RealtimePause() noexcept;
  RealtimePause(const RealtimePause&) = delete;
  RealtimePause& operator=(const RealtimePause&) = delete;

 private:
  bool guarded_;
  char system_calls_;
};

}  // namespace breakaway::testing
