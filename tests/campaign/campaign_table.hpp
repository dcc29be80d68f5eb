// How often each method came to each finding, family by family.
#pragma once

#include <array>
#include <string>

#include "machine_comparison.hpp"

namespace breakaway::campaign {

class CampaignTable {
 public:
  void add(Family family, Method method, const Judgement& judgement);
  long count(Finding finding) const;
  std::string to_markdown() const;

 private:
  struct Row {
    std::array<long, findings> counts{};
    double worst_right = 0;
  };
  std::array<std::array<Row, methods>, families> rows_{};
};

}  // namespace breakaway::campaign
