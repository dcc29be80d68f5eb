// The works of `breakaway tradeoff` under Google Benchmark: integrators, evaluators of k3 and parts of a scenario.
// Compare them within one run only; the counter `each` is the time of one trajectory, call or scenario.
#include <benchmark/benchmark.h>

#include "breakaway/tradeoff/frontiers.hpp"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const auto& work : breakaway::tradeoff::all_works()) {
    benchmark::RegisterBenchmark(work.name.c_str(), [work](benchmark::State& state) {
      const auto ready = work.prepare();
      for (auto _ : state) ready();
      state.counters["each"] =
          benchmark::Counter(work.units, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    });
  }
  benchmark::RunSpecifiedBenchmarks();
}
