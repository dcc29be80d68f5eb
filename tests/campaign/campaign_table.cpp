#include "campaign_table.hpp"

#include <algorithm>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace breakaway::campaign {

void CampaignTable::add(Family family, Method method, const Judgement& judgement) {
  Row& row = rows_.at(static_cast<std::size_t>(family)).at(static_cast<std::size_t>(method));
  ++row.counts.at(static_cast<std::size_t>(judgement.finding));
  if (judgement.finding == Finding::right) row.worst_right = std::max(row.worst_right, judgement.error);
}

long CampaignTable::count(Finding finding) const {
  long sum = 0;
  for (const auto& family : rows_) {
    for (const Row& row : family) sum += row.counts.at(static_cast<std::size_t>(finding));
  }
  return sum;
}

std::string CampaignTable::to_markdown() const {
  std::ostringstream text;
  text << "| family | method |";
  for (int f = 0; f < findings; ++f) text << ' ' << to_string(static_cast<Finding>(f)) << " |";
  text << " worst right error |\n|---|---|";
  for (int f = 0; f < findings; ++f) text << "---|";
  text << "---|\n";
  for (int f = 0; f < families; ++f) {
    for (int m = 0; m < methods; ++m) {
      const Row& row = rows_.at(static_cast<std::size_t>(f)).at(static_cast<std::size_t>(m));
      if (std::accumulate(row.counts.begin(), row.counts.end(), 0L) == 0) continue;
      text << "| " << to_string(static_cast<Family>(f)) << " | " << to_string(static_cast<Method>(m)) << " |";
      for (const long count : row.counts) text << ' ' << count << " |";
      text << ' ' << std::setprecision(2) << row.worst_right << " |\n";
    }
  }
  return text.str();
}

}  // namespace breakaway::campaign
