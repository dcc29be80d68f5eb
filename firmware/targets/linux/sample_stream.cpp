#include "sample_stream.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>

#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {
namespace {

class JsonLine {
 public:
  explicit JsonLine(std::string_view axis) : axis_{axis} {}

  template <class Number>
  void node(std::string_view name, const Number& number) {
    fmt::format_to(std::back_inserter(text_), "{}\"{}\":{}", text_.empty() ? "{" : ",", name, number);
  }
  template <class Number>
  void axis(std::string_view name, const Number& number) {
    node(axis_.empty() ? std::string{name} : fmt::format("{}/{}", axis_, name), number);
  }
  // JSON knows no other numbers.
  void real(std::string_view name, double number) {
    if (std::isfinite(number)) axis(name, fmt::format("{:.9g}", number));
  }
  // 32 bits of counts have ten digits, and a count that is no power of ten has more.
  void place(std::string_view name, double position_m) { axis(name, fmt::format("{:.12g}", position_m)); }
  std::string text() && { return std::move(text_) + "}"; }

 private:
  std::string_view axis_;
  std::string text_;
};

struct Place {
  std::string host, port;
};

InputError no_destination(const std::string& text) {
  return InputError{fmt::format(
      "--stream {}: is not udp:HOST:PORT with a port from 1 to 65535, as udp:localhost:9870 or udp:[::1]:9870", text)};
}

bool is_port(const std::string& text) {
  return !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == text.npos &&
         std::stoi(text) >= 1 && std::stoi(text) <= 65535;
}

Place parse(const std::string& text) {
  constexpr std::string_view scheme = "udp:";
  const std::size_t colon = text.rfind(':');
  if (!text.starts_with(scheme) || colon < scheme.size()) throw no_destination(text);
  Place place{text.substr(scheme.size(), colon - scheme.size()), text.substr(colon + 1)};
  const bool bracketed = place.host.size() > 2 && place.host.front() == '[' && place.host.back() == ']';
  if (bracketed) place.host = place.host.substr(1, place.host.size() - 2);
  // Without brackets it could not be told which colon is the port's.
  const bool ambiguous = !bracketed && place.host.find_first_of(":[]") != place.host.npos;
  if (place.host.empty() || ambiguous || !is_port(place.port)) throw no_destination(text);
  return place;
}

struct FreeAddresses {
  void operator()(addrinfo* first) const { freeaddrinfo(first); }
};

// A socket that is connected to the first address to which there is a way, and never waits.
int socket_to(const std::string& text) {
  const Place place = parse(text);
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(place.host.c_str(), place.port.c_str(), &hints, &found); error != 0)
    throw InputError{fmt::format("--stream {}: the host is not found: {}; give its address", text,
                                 error == EAI_SYSTEM ? std::strerror(errno) : gai_strerror(error))};
  const std::unique_ptr<addrinfo, FreeAddresses> addresses{found};
  int problem = 0;
  for (const addrinfo* to = addresses.get(); to != nullptr; to = to->ai_next) {
    const int socket = ::socket(to->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket >= 0 && connect(socket, to->ai_addr, to->ai_addrlen) == 0) return socket;
    problem = errno;
    if (socket >= 0) close(socket);
  }
  throw InputError{fmt::format("--stream {}: there is no way to that host: {}; `ip route` lists the ways", text,
                               std::strerror(problem))};
}

}  // namespace

std::string encode_sample(const StepRecord& step, double resolution_m, std::string_view axis,
                          const StreamContext& context) {
  constexpr std::chrono::seconds second{1};
  JsonLine line{axis};
  line.node("timestamp", fmt::format("{}.{:06}", context.since_epoch / second,
                                     context.since_epoch % second / std::chrono::microseconds{1}));
  line.node("sample", context.number);
  line.node("dropped", context.dropped);
  line.node("bus_load", fmt::format("{:.4g}", context.bus_load));
  if (step.controlled) {
    line.node("latency_us", fmt::format("{:.3f}", std::chrono::duration<double, std::micro>(step.latency).count()));
    line.place("target_m", step.target_counts * resolution_m);
    line.place("error_m", (static_cast<double>(step.position_counts) - step.target_counts) * resolution_m);
    line.real("command_N", static_cast<double>(step.command_N));
    line.axis("mode", static_cast<int>(step.mode));
  }
  line.place("position_m", step.position_counts * resolution_m);
  line.real("reported_N", static_cast<double>(step.reported_N));
  line.axis("drive", static_cast<int>(step.drive));
  line.axis("fault", static_cast<int>(step.fault));
  line.axis("fault_code", step.fault_code);
  line.axis("stop_not_obeyed", int{step.stop_not_obeyed});
  line.axis("link_lost", int{step.link_lost});
  return std::move(line).text();
}

SampleStream::SampleStream(const std::string& destination, const std::vector<AxisPlan>& axes)
    : axes_{axes}, destination_{destination}, socket_{socket_to(destination)} {}

SampleStream::~SampleStream() { close(socket_); }

void SampleStream::send(const StepRecord& step, hal::Duration since_epoch, double bus_load, std::uint64_t lost) {
  const AxisPlan& axis = axes_[step.axis];
  const std::string text =
      encode_sample(step, axis.resolution_m, axes_.size() > 1 ? axis.name : std::string_view{},
                    {.since_epoch = since_epoch, .number = number_, .dropped = refused_ + lost, .bus_load = bus_load});
  if (::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()))
    ++number_;
  else
    ++refused_;
}

std::string SampleStream::report(std::uint64_t lost) const {
  return fmt::format(
      "stream      {} samples sent to {}; not sent: {} that nobody took, {} that the ring had no room for\n", number_,
      destination_, refused_, lost);
}

}  // namespace breakaway::linux_node
