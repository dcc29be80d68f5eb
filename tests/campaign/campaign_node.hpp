// The flashed node of the fault campaigns: one axis of 1 kg on friction of 2.5 to 4.5 N, limited to half of what its
// drive could do.
#pragma once

#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "fault_world.hpp"

namespace breakaway::campaign {

inline CampaignNode make_node(bool absolute_encoder) {
  CampaignNode node;
  node.loop.network.period = FaultWorld::period;
  firmware::FlashedAxis<float>& axis = node.axes[0];
  axis.name.characters[0] = 'x';
  axis.drive = {.node_id = FaultWorld::drive_id,
                .force_per_torque_N_per_Nm = 50,
                .rated_torque_mNm = 500,
                .absolute_encoder = absolute_encoder};
  axis.limits.position_min_m = -1.5F;
  axis.limits.position_max_m = 1.5F;
  axis.limits.speed_m_s = 6;
  axis.limits.force_N = 60;
  axis.limits.following_error_m = 0.2F;
  axis.law = {1, 400, 32, 60, {2.5F, 4.5F}, static_cast<float>(FaultWorld::max_force_N), 5, 2e-6F, 1e-6F, 1e-3F};
  axis.k3_table = design::build_k3_table<float>({axis.law.mass_kg, axis.law.stiffness_N_per_m,
                                                 axis.law.kick_damping_Ns_per_m, axis.law.friction.lower_N},
                                                axis.law.stick_radius_upper_m())
                      .table;
  axis.kicks.table = design::design_pd_kicks(axis.law).table;
  axis.certified = true;
  node.checksum = checksum_of(node);
  return node;
}

}  // namespace breakaway::campaign
