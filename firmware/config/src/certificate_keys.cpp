#include "breakaway/config/certificate_keys.hpp"

#include <array>

namespace breakaway::config {
namespace {

using enum Standing;

constexpr std::array rows{
    CertificateKey{"", "title", apart},
    CertificateKey{"", "axis", counted},
    CertificateKey{"", "plant", counted},
    CertificateKey{"", "friction", counted},
    CertificateKey{"", "controller", counted},
    CertificateKey{"", "drive", counted},
    CertificateKey{"", "limits", counted},
    CertificateKey{"", "told", counted},
    CertificateKey{"", "uncertainty", counted},
    CertificateKey{"", "move", counted},
    CertificateKey{"", "loop", counted},
    CertificateKey{"", "bus", counted},
    CertificateKey{"", "run", counted},
    CertificateKey{"", "machine", refused,
                   "a certificate is of an axis that moves alone, and here its axes move one another; simulate it"},
    CertificateKey{"", "start", apart},

    CertificateKey{"axis", "name", apart},
    CertificateKey{"axis", "plant", counted},
    CertificateKey{"axis", "friction", counted},
    CertificateKey{"axis", "controller", counted},
    CertificateKey{"axis", "drive", counted},
    CertificateKey{"axis", "limits", counted},
    CertificateKey{"axis", "told", counted},
    CertificateKey{"axis", "uncertainty", counted},
    CertificateKey{"axis", "move", counted},

    CertificateKey{"plant", "mass_kg", counted},
    CertificateKey{"plant", "position_m", apart},
    CertificateKey{"plant", "velocity_m_s", apart},
    CertificateKey{"plant", "force_N", bounded},
    CertificateKey{"plant", "cogging", bounded},
    CertificateKey{"plant", "ripple", bounded},
    CertificateKey{"plant", "drift", bounded},
    CertificateKey{"plant", "presliding", bounded},
    CertificateKey{"plant", "load", refused,
                   "a certificate is of one rigid mass, and here a load hangs behind a spring; simulate it, or leave "
                   "the table out where the spring is as good as rigid"},
    CertificateKey{"plant", "backlash", refused,
                   "a certificate is of a mechanism without play; simulate it, or leave the table out"},
    CertificateKey{"plant", "encoder_error", bounded},
    CertificateKey{"plant", "machine", apart},

    CertificateKey{"friction", "lower_N", counted},
    CertificateKey{"friction", "upper_N", counted},
    CertificateKey{"friction", "mu_lower", counted},
    CertificateKey{"friction", "mu_upper", counted},
    CertificateKey{"friction", "gravity_m_s2", counted},
    CertificateKey{"friction", "presliding_stiffness_N_per_m", counted},
    CertificateKey{"friction", "smooth_slope_Ns_per_m", counted},
    CertificateKey{"friction", "law", bounded},

    CertificateKey{"controller", "kind", counted},
    CertificateKey{"controller", "k1_N_per_m", counted},
    CertificateKey{"controller", "k21_Ns_per_m", counted},
    CertificateKey{"controller", "k22_Ns_per_m", counted},
    CertificateKey{"controller", "kick", counted},
    CertificateKey{"controller", "coast", counted},
    CertificateKey{"controller", "kp_N_per_m", apart},
    CertificateKey{"controller", "ki_N_per_ms", apart},
    CertificateKey{"controller", "kd_Ns_per_m", apart},
    CertificateKey{"controller", "feedforward_N", counted},
    CertificateKey{"controller", "max_force_N", counted},
    CertificateKey{"controller", "max_approach_speed_m_s", counted},
    CertificateKey{"controller", "position_tolerance_m", counted},
    CertificateKey{"controller", "target_m", counted},
    CertificateKey{"controller", "targets", counted},
    CertificateKey{"controller", "scalar", apart},

    CertificateKey{"targets", "time_s", apart},

    CertificateKey{"drive", "node_id", apart},
    CertificateKey{"drive", "rated_torque_Nm", counted},
    CertificateKey{"drive", "rated_current_A", apart},
    CertificateKey{"drive", "max_torque_per_mille", counted},
    CertificateKey{"drive", "force_per_torque_N_per_Nm", counted},
    CertificateKey{"drive", "peak_force_N", counted},
    CertificateKey{"drive", "encoder_resolution_m", counted},
    CertificateKey{"drive", "current_loop_time_constant_s", counted},
    CertificateKey{"drive", "invert_direction", apart},
    CertificateKey{"drive", "encoder", apart},
    CertificateKey{"drive", "heartbeat_period_s", apart},
    CertificateKey{"drive", "heartbeat_timeout_s", apart},
    CertificateKey{"drive", "sdo_timeout_s", apart},
    CertificateKey{"drive", "tpdo_delay_min_s", apart},
    CertificateKey{"drive", "tpdo_delay_max_s", bounded},
    CertificateKey{"drive", "seed", apart},
    CertificateKey{"drive", "quirks", apart},

    CertificateKey{"quirks", "mode_display_delay_s", apart},
    CertificateKey{"quirks", "needs_mode_to_enable", apart},
    CertificateKey{"quirks", "min_controlword_interval_s", apart},
    CertificateKey{"quirks", "sync_alarm_periods", apart},
    CertificateKey{"quirks", "torque_relative_to_max", apart},
    CertificateKey{"quirks", "interpolation_in_ms_only", apart},
    CertificateKey{"quirks", "position_reversed", apart},
    CertificateKey{"quirks", "position_range_counts", apart},
    CertificateKey{"quirks", "refuses_start_with", apart},
    CertificateKey{"quirks", "self_starting", apart},
    CertificateKey{"quirks", "maps_in_pre_operational_only", apart},
    CertificateKey{"quirks", "no_boot_up_message", apart},
    CertificateKey{"quirks", "counts_from_power_on", apart},

    CertificateKey{"limits", "position_m", counted},
    CertificateKey{"limits", "position_min_m", counted},
    CertificateKey{"limits", "position_max_m", counted},
    CertificateKey{"limits", "speed_m_s", counted},
    CertificateKey{"limits", "force_N", counted},
    CertificateKey{"limits", "following_error_m", counted},
    CertificateKey{"limits", "feedback_timeout_s", apart},

    CertificateKey{"told", "mass_kg", counted},
    CertificateKey{"told", "force_gain", counted},
    CertificateKey{"told", "friction_lower_N", counted},
    CertificateKey{"told", "friction_upper_N", counted},
    CertificateKey{"told", "latency_periods", counted},

    CertificateKey{"uncertainty", "mass", counted},
    CertificateKey{"uncertainty", "force_gain", counted},
    CertificateKey{"uncertainty", "force_N", counted},
    CertificateKey{"uncertainty", "current_loop_time_constant", counted},
    CertificateKey{"uncertainty", "jitter_s", counted},
    CertificateKey{"uncertainty", "encoder_noise_m", counted},

    CertificateKey{"move", "distance_m", counted},
    CertificateKey{"move", "speed_m_s", counted},
    CertificateKey{"move", "acceleration_m_s2", counted},
    CertificateKey{"move", "jerk_m_s3", counted},

    CertificateKey{"loop", "period_s", counted},
    CertificateKey{"loop", "node_id", apart},
    CertificateKey{"loop", "heartbeat_period_s", apart},
    CertificateKey{"loop", "command_timeout_s", apart},
    CertificateKey{"loop", "fault_stops", apart},
    CertificateKey{"loop", "moves_end", apart},

    CertificateKey{"bus", "bit_rate", counted},
    CertificateKey{"bus", "loss_probability", bounded},
    CertificateKey{"bus", "delay_min_s", bounded},
    CertificateKey{"bus", "delay_max_s", bounded},
    CertificateKey{"bus", "seed", apart},

    CertificateKey{"run", "settle_tolerance_m", counted},
    CertificateKey{"run", "duration_s", apart},
    CertificateKey{"run", "settle_time_s", apart},
    CertificateKey{"run", "stop_when_settled", apart},
    CertificateKey{"run", "accuracy_m", apart},
};

}  // namespace

std::span<const CertificateKey> certificate_keys() { return rows; }

}  // namespace breakaway::config
