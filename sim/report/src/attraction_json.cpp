#include "breakaway/report/attraction_json.hpp"

#include <cmath>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/report/conditions_json.hpp"

namespace breakaway::report {
namespace {

using study::Attraction;
using study::Fate;

template <class Vector>
void write_numbers(format::JsonWriter& json, const Vector& numbers) {
  json.array([&] {
    for (const double number : numbers) json.value(number);
  });
}

void write_equilibria(format::JsonWriter& json, const Attraction& found, const Regions& sections) {
  Eigen::MatrixXd vertices;
  std::string reason;
  try {
    vertices = found.equilibria.vertices();
  } catch (const InputError& error) {
    reason = error.what();
  }
  json.array("vertices", [&] {
    for (const auto corner : vertices.colwise()) write_numbers(json, corner);
  });
  json.array("extent", [&] {
    for (const double extent : found.equilibria.extent()) json.value(extent);
  });
  json.member("section_area", stability::area(sections.equilibria));
  json.member("reason", reason);
}

void write_theorem(format::JsonWriter& json, const Attraction& found) {
  const stability::Attractivity& a = found.attractivity();
  write_conditions(json, a.conditions);
  json.member("certified", a.certified);
  json.member("reason", a.reason);
  json.array("eigenvalues", [&] {
    for (const double value : a.eigenvalues) json.value(value);
  });
  json.member("alpha", a.alpha);
  json.member("beta", a.beta);
  json.array("rho_J", [&] {
    for (const double rho : a.rho_J) json.value(rho);
  });
  json.member("rho_star_J", a.rho_star_J);
  json.member("rho_star_closed_form_J", found.closed_form_J.value_or(std::nan("")));
  json.member("level_J", a.level_J);
  json.member("global", a.global());
  json.member("E_certified", a.all_of_E);
  json.member("E_share_certified", a.certified_share_of_E());
  json.member("E_greatest_energy_J", a.greatest_rest_J);
  json.member("remark_3_energy_J", a.remark_3_J);
  json.member("remark_3_holds", a.remark_3_J < a.rho_star_J);
}

void write_region(format::JsonWriter& json, const Attraction& found, const Regions& sections) {
  const study::CertifiedRegion& region = *found.region;
  json.array("plane", [&] {
    for (const int place : region.window().plane) json.value(place + 1);
  });
  json.member("window", region.window().half_width);
  json.member("certified_area_theorem_1", stability::area(sections.certified));
  json.member("certified_area", region.area(Fate::attracted));
  json.member("certified_lost_area", region.area(Fate::lost));
  json.member("true_area", region.area_simulated(Fate::attracted));
  json.member("undecided_area", region.area_simulated(Fate::undecided));
  json.member("certified_share", region.proved_share());
  json.member("motions", region.motions());
}

}  // namespace

Regions regions(const stability::LinearMachine<>& machine, const Attraction& found) {
  if (!found.region) return {};
  const study::Window& window = found.region->window();
  return regions(machine, found.certificates, {2, window.half_width, window.plane});
}

std::string to_json(const scenario::MachineScenario& s, const Attraction& found) {
  const Regions sections = regions(s.machine, found);
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    write_theorem(json, found);
    json.object("equilibrium_set", [&] { write_equilibria(json, found, sections); });
    if (found.region) {
      write_region(json, found, sections);
    } else {
      json.member("certified_area", 0.0);
    }
    json.array("sweep", [&] {
      for (const study::SweepRow& row : found.sweep) {
        json.object([&] {
          json.member("d1", row.d1);
          json.member("rho_star_J", row.attractivity.rho_star_J);
          json.member("E_certified", row.attractivity.all_of_E);
          json.member("global", row.attractivity.global());
          json.member("reason", row.attractivity.reason);
        });
      }
    });
  });
  return json.text();
}

}  // namespace breakaway::report
