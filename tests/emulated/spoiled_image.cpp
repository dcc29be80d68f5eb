// Everything that toolchain/check_image.py is to refuse, so that it is known to refuse it. Never run.
#include <cstdlib>

namespace {

volatile double measured = 1.5;
volatile int depth = 3;

[[gnu::noinline]] int recurse(int n) {
  const int below = n > 0 ? recurse(n - depth) : 0;
  return below + depth;
}

[[gnu::noinline]] int grow(int n) {
  auto* const frame = static_cast<volatile char*>(__builtin_alloca(static_cast<unsigned>(n)));
  frame[0] = 1;
  return frame[0];
}

int (*volatile somewhere)(int) = recurse;
void* volatile kept = nullptr;

}  // namespace

// Without a heap an image that allocates does not link; this one brings a heap.
extern "C" void* _sbrk(int) { return nullptr; }

void run_image() {
  measured = measured * 1.1;
  depth = grow(recurse(depth)) + somewhere(1);
  kept = std::malloc(static_cast<unsigned>(depth));
}
