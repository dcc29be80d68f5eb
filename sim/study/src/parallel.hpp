// The threads of this room.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace breakaway::study {

// Does the jobs 0 .. count - 1 on `threads` >= 1 threads, of which the caller's is one, `at_a_time` >= 1 of them to
// whichever thread is free. Each thread asks make_worker(thread) once for what does a job(i), so that it can have an
// integrator of its own. The first exception ends all threads and is thrown again here.
template <class MakeWorker>
void in_parallel(std::size_t count, int threads, std::size_t at_a_time, const MakeWorker& make_worker) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&](int thread) {
    try {
      auto&& job = make_worker(thread);
      for (std::size_t first = next.fetch_add(at_a_time); first < count; first = next.fetch_add(at_a_time)) {
        const std::size_t end = std::min(first + at_a_time, count);
        for (std::size_t i = first; i < end; ++i) job(i);
      }
    } catch (...) {
      const std::scoped_lock lock{mutex};
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> pool;
    pool.reserve(static_cast<std::size_t>(threads));
    for (int thread = 1; thread < threads; ++thread) pool.emplace_back(work, thread);
    work(0);  // a signal that ends the caller is seen on the caller's thread only
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace breakaway::study
