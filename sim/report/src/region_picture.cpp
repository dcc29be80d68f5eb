#include "breakaway/report/region_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "picture_parts.hpp"

namespace breakaway::report {
namespace {

constexpr int finest_level = 10;  // about a thousand pixels along each axis: a picture shows no more

constexpr const char* region_style = R"(
set palette defined (0 '#4d5966', 1 '#e3ebf1', 2 '#f0cf8e', 3 '#a9803a', 4 '#7d5a8c')
set palette maxcolors 5
set cbrange [-0.5:4.5]
set key above center horizontal maxrows 2 samplen 1.2 width -2 textcolor '#333333'
)";

// Lost, attracted, and not proved to be one of them: by simulation attracted, lost, or undecided.
char shade(const study::Cell& cell) {
  if (cell.proved == study::Fate::lost) return '0';
  if (cell.proved == study::Fate::attracted) return '1';
  if (cell.simulated == study::Fate::undecided) return '4';
  return cell.simulated == study::Fate::attracted ? '2' : '3';
}

std::string image(const study::CertifiedRegion& region, int level) {
  const std::size_t side = std::size_t{1} << level;
  std::vector<std::string> rows(side, std::string(side, '0'));
  for (const study::Cell& cell : region.cells()) {
    const auto first = [&](int index) {
      return static_cast<std::size_t>(cell.level <= level ? index << (level - cell.level)
                                                          : index >> (cell.level - level));
    };
    const std::size_t width = std::size_t{1} << std::max(0, level - cell.level);
    for (std::size_t row = first(cell.row); row < first(cell.row) + width; ++row) {
      std::fill_n(rows[row].begin() + static_cast<std::ptrdiff_t>(first(cell.column)), width, shade(cell));
    }
  }
  std::string text = "$fates << END\n";
  for (const std::string& row : rows) {
    for (const char pixel : row) (text += pixel) += ' ';
    text += '\n';
  }
  return text + "END\n";
}

}  // namespace

std::string draw_region(const std::string& path, const scenario::MachineScenario& s,
                        const study::CertifiedRegion& region, const Regions& regions) {
  const study::Window& window = region.window();
  const int level = std::min(window.depth, finest_level);
  const double side = 2 * window.half_width / (1 << level);
  std::string commands = plane_style(s.machine, window.plane, window.half_width) + region_style + image(region, level) +
                         region_outlines(regions);
  commands += fmt::format(
      "plot $fates matrix using ({0}+{1}*($1+0.5)):({0}+{1}*($2+0.5)):3 with image notitle, "
      "NaN with boxes linecolor '#e3ebf1' title 'proved: attracted', "
      "NaN with boxes linecolor '#f0cf8e' title 'simulated: attracted', "
      "NaN with boxes linecolor '#4d5966' title 'proved: lost', "
      "NaN with boxes linecolor '#a9803a' title 'simulated: lost'",
      -window.half_width, side);
  if (region.area_simulated(study::Fate::undecided) > 0)
    commands += ", NaN with boxes linecolor '#7d5a8c' title 'undecided'";
  return draw_plane(path, commands + plot_regions(regions) + "\n");
}

}  // namespace breakaway::report
