// What the C library asks of a system, for the world's image alone: a heap, and an end. The controller has neither.
#include <cstddef>

#include "semihosting.hpp"

extern "C" {

extern char image_heap_begin[], image_heap_end[];

void* __dso_handle = nullptr;
int __aeabi_atexit(void*, void (*)(void*), void*) {
  return 0;
}  // nothing is destroyed: the image ends by exit_emulator

void* _sbrk(std::ptrdiff_t increment) {
  static char* end = image_heap_begin;
  if (increment > image_heap_end - end) return reinterpret_cast<void*>(-1);
  char* const begin = end;
  end += increment;
  return begin;
}

[[noreturn]] void _exit(int) { breakaway::emulated::exit_emulator(100); }
int _kill(int, int) { _exit(1); }
int _getpid() { return 1; }
int _write(int, const void*, int) { return -1; }
int _read(int, void*, int) { return -1; }
int _close(int) { return -1; }
int _lseek(int, int, int) { return -1; }
int _fstat(int, void*) { return -1; }
int _isatty(int) { return 0; }

}  // extern "C"
