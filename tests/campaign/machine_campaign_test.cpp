// Every method on random machines, against an independent computation in numbers of 113 bits. Each machine depends on
// its number only; README.md says how any of them is run again, and how a long campaign is run.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "campaign_table.hpp"
#include "environment.hpp"
#include "isolated.hpp"
#include "known_defects.hpp"

namespace {

using namespace breakaway::campaign;

struct Settings {
  long first = from_environment("BREAKAWAY_FIRST_SYSTEM", 0);
  long count = from_environment("BREAKAWAY_SYSTEMS", 1000);
  long cpu_s = from_environment("BREAKAWAY_CPU_S", 0);
  double reference_work = number_from_environment("BREAKAWAY_WORK", ComparisonOptions{}.most_work);
  std::string method = text_from_environment("BREAKAWAY_METHOD");
  std::string family = text_from_environment("BREAKAWAY_FAMILY");
  std::string failures = text_from_environment("BREAKAWAY_FAILURES");
  std::string results = text_from_environment("BREAKAWAY_RESULTS");
  bool wants(Family of) const { return family.empty() || family == to_string(of); }
  static bool whole() { return set_in_environment("BREAKAWAY_SYSTEMS"); }
};

// Steps of time stepping are many, so that only some machines are worth them.
bool is_due(const Settings& settings, const RandomMachine& random, Method method) {
  if (!settings.method.empty()) return settings.method == to_string(method);
  if (!settings.whole() && !is_clean(random.family, method)) return false;
  return method != Method::time_stepping || random.number / families % 16 == 0;
}

void write_scene(const Settings& settings, const RandomMachine& random, Method method, const Judgement& judgement) {
  if (settings.failures.empty()) return;
  std::ofstream file{settings.failures, std::ios::app};
  file << "# " << to_string(method) << ": " << to_string(judgement.finding) << ", error " << judgement.error << ", "
       << judgement.note << "\n"
       << to_scene(random) << "\n";
}

void judge_machine(const Settings& settings, const RandomMachine& random, CampaignTable& table) {
  ComparisonOptions options;
  // A long campaign ends a run by the seconds that it may take, and lets it make as many steps as it likes.
  options.most_cpu_s = settings.cpu_s;
  if (settings.cpu_s > 0) options.most_steps = 1'000'000'000;
  options.most_work = settings.reference_work;
  Comparison comparison{random, options};
  for (int m = 0; m < methods; ++m) {
    const auto method = static_cast<Method>(m);
    if (!is_due(settings, random, method)) continue;
    const Judgement found = isolated(settings.cpu_s > 0, [&] { return comparison.judge(method); });
    table.add(random.family, method, found);
    const bool known = is_known_defect(random.number, method);
    if (is_defect(found.finding)) write_scene(settings, random, method, found);
    EXPECT_EQ(is_defect(found.finding), known)
        << "machine " << random.number << ", " << to_string(random.family) << ", " << to_string(method) << ": "
        << to_string(found.finding) << ", error " << found.error << " " << found.note
        << (known ? "\nIt is mended: take it off the list in known_defects.hpp." : "");
  }
}

void report_progress(long done, long count) {
  if (isatty(STDERR_FILENO) == 1 && done % 50 == 0) std::fprintf(stderr, "\r%ld of %ld machines", done, count);
}

TEST(MachineCampaign, EveryMethodIsRightOrRefusesByName) {
  const Settings settings;
  CampaignTable table;
  long done = 0;
  for (long number = settings.first; done < settings.count; ++number) {
    if (!settings.wants(static_cast<Family>(number % families))) continue;
    judge_machine(settings, random_machine(number), table);
    report_progress(++done, settings.count);
  }
  const std::string text = table.to_markdown();
  std::printf("%s", text.c_str());
  if (!settings.results.empty()) std::ofstream{settings.results} << text;
}

// What a long campaign has found beyond the numbers that the test takes, what is right of it, and how it was wrong.
struct FoundMachine {
  long number;
  Finding finding;
  const char* cause;
};
constexpr FoundMachine found_machines[] = {
    {30282, Finding::right, "a speed that drifts was taken to have settled, and its stop was missed"},
    {42094, Finding::right, "slow motions that look alike beside a light mass took 400,000 steps, rounded each"},
    {85661, Finding::right, "as 42094"},
    {87371, Finding::right, "as 42094"},
    {98161, Finding::sensitive, "it rests 1.7 s before the last 4e-16 of the motion have died out"},
};

TEST(MachineCampaign, MachinesThatALongRunFoundAreAsTheyMustBe) {
  for (const FoundMachine& machine : found_machines) {
    const Judgement judgement = Comparison{random_machine(machine.number), {}}.judge(Method::event_driven);
    EXPECT_EQ(judgement.finding, machine.finding)
        << "machine " << machine.number << ": " << to_string(judgement.finding) << ", error " << judgement.error << " "
        << judgement.note << "; " << machine.cause;
  }
}

}  // namespace
