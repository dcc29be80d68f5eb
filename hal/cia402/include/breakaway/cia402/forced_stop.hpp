// ForcedStop: takes the force off a drive that was told to stop and is still seen energised, or not seen at all.
//
// The usual way to stop is the controlword of the RPDO, which acts at SYNC and has no answer: a drive whose RPDO
// another tool switched off, or that does not hear SYNC, keeps its last torque. So ever stronger means follow, each
// with its time, over and over until one works, and with more patience for an answer in each round:
//
//   controlword      0 is written to 6040h by SDO, which acts without PDO and SYNC
//   pre_operational  NMT Enter Pre-operational ends the PDOs, and 6040h is written again
//   reset            NMT Reset node; what boots anew has no force
//
// Each has at least the updates that a proof takes, in which an obedient drive of a slow loop answers.
// All the while 6041h is read after each write. The proof that the stop is obeyed is a statusword that shows a state
// without force, and then a 6077h that shows no torque; so is a boot-up, which the owner sees. A drive without 6077h is
// believed for its state. While a request waits for others to be sent, the time stands still.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

class ForcedStop {
 public:
  enum class Means : std::uint8_t { controlword, pre_operational, reset };

  static constexpr hal::Duration controlword_time = std::chrono::milliseconds{100};
  static constexpr hal::Duration pre_operational_time = std::chrono::milliseconds{200};
  // To boot in; twice as long in each further round, up to the longest.
  static constexpr hal::Duration reset_time = std::chrono::seconds{2};
  static constexpr hal::Duration longest_reset_time = std::chrono::seconds{16};
  // A write and two reads that are each answered by the next update, or the second, end in a proof first.
  static constexpr std::uint8_t least_updates = 5;
  static constexpr hal::Duration round_time = controlword_time + pre_operational_time + reset_time;

  // So long after the first of them since begin(), refusals that may pass are no reason to wait any more.
  static constexpr hal::Duration refusal_time = std::chrono::seconds{3};

  // A twentieth of the rated torque, in per mille, may be an offset of a current measurement where no current flows.
  static constexpr int most_idle_torque = 50;

  // Begins with the first means. The transfers are made by the node's SDO client, which must be free; in the first
  // round each has the patience (> 0), in each further one more (patience.hpp).
  void begin(canopen::SdoClient& sdo, hal::Duration patience, hal::Time now) noexcept;
  // Goes on where it ended, because what proved the stop was not so. After a reset the next round begins.
  void resume(canopen::SdoClient& sdo, hal::Time now) noexcept;
  // Once a period. Returns true when the proof was read.
  bool update(canopen::SdoClient& sdo, hal::Time now) noexcept;
  // The NMT command that is to be sent now, if one is; given once.
  std::optional<canopen::NmtCommand> take_command() noexcept;

  Means means() const noexcept { return means_; }
  // Whether 6077h is to be read beside a state without force; not of a drive that said since begin() that it has none.
  bool reads_torque() const noexcept { return reads_torque_; }
  // Returns true where the read that ended so was refused, and would be again: what may pass is waited for.
  bool is_refused(const canopen::SdoClient& sdo, canopen::SdoResult result, hal::Time now) noexcept;
  // Returns true where the read of 6077h that ended so shows no torque, or can show none.
  bool shows_no_torque(const canopen::SdoClient& sdo, canopen::SdoResult result, hal::Time now) noexcept;

 private:
  enum class Transfer : std::uint8_t { none, write_controlword, read_statusword, read_torque };

  Transfer after(const canopen::SdoClient& sdo, Transfer finished, canopen::SdoResult result, hal::Time now) noexcept;
  void escalate(canopen::SdoClient& sdo, hal::Time now) noexcept;
  void start(canopen::SdoClient& sdo, Transfer transfer) noexcept;
  hal::Duration time_of(Means means) const noexcept;

  Means means_ = Means::controlword;
  hal::Time since_{};         // of this means
  hal::Time last_{};          // update
  std::uint8_t updates_ = 0;  // of this means, up to the least
  hal::Duration patience_{};
  hal::Duration reset_time_ = reset_time;  // in this round
  Transfer transfer_ = Transfer::none;
  std::optional<hal::Time> refused_since_;  // with codes that may pass
  bool reads_torque_ = true;
  bool quiet_ = false;  // by the newest answers
  std::optional<canopen::NmtCommand> command_;
};

}  // namespace breakaway::cia402
