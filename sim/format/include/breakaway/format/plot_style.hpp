// The look of the report's pictures.
#pragma once

#include <string>

namespace breakaway::format {

inline constexpr int width_px = 900;

// Commands to gnuplot that come before all others.
inline const std::string plot_style = R"(
set encoding utf8
set border 3 linecolor '#888888'
set tics nomirror out textcolor '#333333'
set grid linecolor '#dcdfe2' linetype 1 linewidth 0.6
set key above left Left reverse horizontal samplen 2 width 1 textcolor '#333333'
set style line 1 linecolor '#1c5d99' linewidth 1.8
set style line 2 linecolor '#c8553d' linewidth 1.8
set style line 3 linecolor '#2a7f62' linewidth 1.8
set style line 4 linecolor '#777777' linewidth 1.2 dashtype 2
set style line 5 linecolor '#8f6bb3' linewidth 1.8
set style line 6 linecolor '#f2c14e' linewidth 7
set style line 7 linecolor '#e08e45' linewidth 7
set style line 8 linecolor '#c8553d' pointtype 7 pointsize 0.5
set lmargin 11
unset mytics
set rmargin 3
set bmargin 3.5
)";

}  // namespace breakaway::format
