#include "breakaway/report/basin_json.hpp"

#include <fmt/format.h>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/report/basin_picture.hpp"

namespace breakaway::report {

using study::Basin;
using study::Fate;

std::string to_json(const scenario::MachineScenario& s, const Basin& basin, const sil::Certificates& certificates,
                    const BasinEffort& simulated) {
  const Regions sections = regions(s.machine, certificates, basin.grid());
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    json.member("grid", basin.grid().points);
    json.member("window", basin.grid().half_width);
    json.array("plane", [&] {
      for (const int place : basin.grid().plane) json.value(place + 1);
    });
    json.member("shard", fmt::format("{}/{}", basin.shard().index, basin.shard().count));
    json.member("points", basin.size());
    json.member("attracted", basin.count(Fate::attracted));
    json.member("lost", basin.count(Fate::lost));
    json.member("undecided", basin.count(Fate::undecided));
    json.member("given_up", basin.given_up());
    json.member("true_area", basin.area(Fate::attracted));
    json.member("certified_area_theorem_1", stability::area(sections.certified));
    json.member("area_equilibria", stability::area(sections.equilibria));
    json.member("rho_star_J", certificates.attractivity.rho_star_J);
    json.member("certified", certificates.attractivity.certified);
    json.member("reason", certificates.attractivity.reason);
    json.member("trajectories", simulated.trajectories);
    json.member("seconds", simulated.seconds);
    json.member("trajectories_per_s", static_cast<double>(simulated.trajectories) / simulated.seconds);
  });
  return json.text();
}

}  // namespace breakaway::report
