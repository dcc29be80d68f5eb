// SdoClient: reads and writes the objects of one node (SDO, CiA 301, 7.2.4), expedited or in segments.
//
// One client talks to one server and makes one transfer at a time. It never blocks and owns no port: frames are handed
// in and out, and time is an argument. A transfer of a few frames takes as many periods:
//
//   if (client.start_read(0x1000, 0) != SdoStart::started) ...
//   once a period: give every received frame to on_frame(), send what next_frame() hands out, and ask poll(now);
//   SdoResult::done: data() holds the value.
//
// A response is taken only while a request waits for one, and only if it can belong to it. What comes late, twice, or
// for another object is passed over, so a lost or doubled frame cannot end up in the wrong object. A server that breaks
// the protocol is told so by an abort, and the transfer has failed; the next one starts afresh.
//
// Values of up to SdoClient::capacity bytes are held in the client: nothing is allocated. All calls are for one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "breakaway/canopen/object_address.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::canopen {

enum class SdoStart : std::uint8_t {
  started,
  busy,        // the last transfer is not finished
  bad_length,  // a value to write has 1 to SdoClient::capacity bytes
};

constexpr std::string_view to_string(SdoStart start) noexcept {
  switch (start) {
    case SdoStart::started:
      return "the transfer has started";
    case SdoStart::busy:
      return "the last transfer is not finished: wait until poll() is no longer busy, or cancel()";
    case SdoStart::bad_length:
      return "bytes must hold 1 to SdoClient::capacity bytes";
  }
  return "unknown start";
}

enum class SdoResult : std::uint8_t {
  done,
  busy,            // ask again in the next period
  timeout,         // the server did not answer in time
  aborted,         // by the server, or here because the object does not fit; abort_code() says why
  protocol_error,  // the server sent unexpected_command(), which CiA 301 forbids at this place
};

constexpr std::string_view to_string(SdoResult result) noexcept {
  switch (result) {
    case SdoResult::done:
      return "the transfer is done";
    case SdoResult::busy:
      return "the transfer is not finished: ask poll() again in the next period";
    case SdoResult::timeout:
      return "the node did not answer in time: check node_id, power, wiring and bit rate, or raise the timeout";
    case SdoResult::aborted:
      return "the transfer was aborted: to_string(abort_code()) says why";
    case SdoResult::protocol_error:
      return "the node answered with a command that CiA 301 forbids there: look for a second node with its node_id";
  }
  return "unknown result";
}

class SdoClient {
 public:
  static constexpr std::size_t capacity = 64;  // bytes of the longest value

  // node_id: the server's, 1..127. timeout: for every single response, above 0.
  SdoClient(std::uint8_t node_id, hal::Duration timeout) noexcept;

  // For every single response from now on, above 0.
  void set_timeout(hal::Duration timeout) noexcept { timeout_ = timeout; }

  // Starts to read an object. Nothing is sent before next_frame() is asked.
  [[nodiscard]] SdoStart start_read(std::uint16_t index, std::uint8_t subindex) noexcept;

  // Starts to write an object. The bytes are copied.
  [[nodiscard]] SdoStart start_write(std::uint16_t index, std::uint8_t subindex,
                                     std::span<const std::uint8_t> bytes) noexcept;

  // Takes any frame that the bus brought; those that are not this server's are passed over.
  void on_frame(const hal::CanFrame& frame) noexcept;

  // Returns true and fills `frame` when a frame is to be sent, which must then be sent: its response is awaited from
  // `now` on.
  bool next_frame(hal::CanFrame& frame, hal::Time now) noexcept;

  // Returns `busy` until the transfer is finished, then how it ended, until the next start. Before the first: `done`.
  SdoResult poll(hal::Time now) noexcept;

  // The value that the last read brought, when poll() says `done`.
  std::span<const std::uint8_t> data() const noexcept { return std::span{buffer_}.first(size_); }

  // Why the last aborted transfer was aborted; SdoAbort::none before any was. out_of_memory is our own, for a value
  // longer than `capacity`.
  SdoAbort abort_code() const noexcept { return abort_code_; }

  // The first byte of the answer that the last protocol_error was for; 0 before any.
  std::uint8_t unexpected_command() const noexcept { return unexpected_command_; }

  bool busy() const noexcept { return phase_ != Phase::idle; }
  // A request was not handed out yet: others that share the bus came first.
  bool request_waits() const noexcept { return request_pending_; }

  // Forgets the transfer without a word to the server, for a node that rebooted. poll() then says `done`.
  void cancel() noexcept;

 private:
  enum class Phase : std::uint8_t { idle, initiate_read, read_segments, initiate_write, write_segments };

  void begin(Phase phase, std::uint16_t index, std::uint8_t subindex) noexcept;
  void request_initiate_read() noexcept;
  void request_initiate_write() noexcept;
  void request_read_segment() noexcept;
  void request_write_segment() noexcept;
  void request(const std::array<std::uint8_t, 8>& bytes) noexcept;
  bool names_object(const hal::CanFrame& frame) const noexcept;

  void on_initiate_read(const hal::CanFrame& frame) noexcept;
  void on_initiate_write(const hal::CanFrame& frame) noexcept;
  void on_read_segment(const hal::CanFrame& frame) noexcept;
  void on_write_segment(const hal::CanFrame& frame) noexcept;

  void finish(SdoResult result) noexcept;
  void tell_abort(SdoAbort code) noexcept;
  void refuse_command(SdoAbort code, std::uint8_t command) noexcept;
  void refuse_length() noexcept;

  std::uint8_t node_id_;
  hal::Duration timeout_;
  Phase phase_ = Phase::idle;
  SdoResult result_ = SdoResult::done;
  SdoAbort abort_code_ = SdoAbort::none;
  std::uint8_t unexpected_command_ = 0;
  ObjectAddress object_{};
  std::array<std::uint8_t, capacity> buffer_{};
  std::size_t size_ = 0;       // bytes in the buffer
  std::size_t announced_ = 0;  // by the server, for a segmented read; 0 when it did not say
  std::size_t sent_ = 0;       // bytes of the buffer that went into segments so far
  bool toggle_ = false;        // of the segment that is asked for or sent
  bool last_segment_ = false;

  hal::CanFrame request_{};
  bool request_pending_ = false;  // next_frame() is to hand it out
  bool awaiting_ = false;         // it was handed out, and no response has come
  hal::Time sent_at_{};
  hal::CanFrame abort_{};
  bool abort_pending_ = false;
};

}  // namespace breakaway::canopen
