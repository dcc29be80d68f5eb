#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>

#include "breakaway/input/input_error.hpp"
#include "breakaway/watch/datagram.hpp"
#include "breakaway/watch/source.hpp"

namespace breakaway::watch {
namespace {

InputError no_place(const std::string& text) {
  return InputError{
      fmt::format("--stream {}: is neither PORT nor ADDRESS:PORT with a port up to 65535, as 9870, "
                  "0.0.0.0:9870 or [::]:9870",
                  text)};
}

struct Address {
  sockaddr_storage bytes{};
  socklen_t size = 0;
};

std::uint16_t read_port(const std::string& text, std::string_view digits) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size()) throw no_place(text);
  return port;
}

Address read_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string host = colon == text.npos ? "127.0.0.1" : text.substr(0, colon);
  const std::uint16_t port = read_port(text, colon == text.npos ? text : std::string_view{text}.substr(colon + 1));
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  Address address;
  sockaddr_in four{};
  sockaddr_in6 six{};
  if (!bracketed && inet_pton(AF_INET, host.c_str(), &four.sin_addr) == 1) {
    four.sin_family = AF_INET;
    four.sin_port = htons(port);
    address.size = sizeof four;
    std::memcpy(&address.bytes, &four, sizeof four);
  } else if (bracketed && inet_pton(AF_INET6, host.c_str(), &six.sin6_addr) == 1) {
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(port);
    address.size = sizeof six;
    std::memcpy(&address.bytes, &six, sizeof six);
  } else {
    throw no_place(text);
  }
  return address;
}

class Socket {
 public:
  explicit Socket(const std::string& text) {
    const Address address = read_address(text);
    const auto* const place = reinterpret_cast<const sockaddr*>(&address.bytes);
    descriptor_ = ::socket(place->sa_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor_ >= 0 && bind(descriptor_, place, address.size) == 0) return;
    const int error = errno;
    if (descriptor_ >= 0) close(descriptor_);
    throw InputError{
        fmt::format("--stream {}: cannot be received at: {}; choose another port, or end what receives there", text,
                    std::strerror(error))};
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() { close(descriptor_); }

  int descriptor() const { return descriptor_; }

  std::uint16_t port() const {
    sockaddr_storage bytes{};
    socklen_t size = sizeof bytes;
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&bytes), &size);
    // The port stands at the same place for both families.
    sockaddr_in four{};
    std::memcpy(&four, &bytes, sizeof four);
    return ntohs(four.sin_port);
  }

 private:
  int descriptor_ = -1;
};

class ReceivedStream final : public Source {
 public:
  ReceivedStream(const std::string& place, History& history) : place_{place}, history_{history}, socket_{place} {
    thread_ = std::jthread{[this](const std::stop_token& stop) { run(stop); }};
  }

  std::string description() const override { return fmt::format("stream to UDP port {}", socket_.port()); }

 private:
  void run(const std::stop_token& stop) {
    constexpr int patience_ms = 100;
    pollfd watched{.fd = socket_.descriptor(), .events = POLLIN, .revents = 0};
    while (!stop.stop_requested())
      if (poll(&watched, 1, patience_ms) > 0) receive();
  }

  void receive() {
    std::array<char, 65536> text;
    const ssize_t size = recv(socket_.descriptor(), text.data(), text.size(), 0);
    if (size < 0) return;
    try {
      take(read_datagram({text.data(), static_cast<std::size_t>(size)}));
    } catch (const InputError& error) {
      history_.complain(error.what());
    }
  }

  // A number that is lower than the last one is that of a new run.
  void take(Datagram datagram) {
    if (expected_ && datagram.number > *expected_) history_.add_lost_on_the_way(datagram.number - *expected_);
    expected_ = datagram.number + 1;
    history_.set_lost_at_sender(datagram.dropped);
    history_.add(std::move(datagram.sample));
  }

  std::string place_;
  History& history_;
  Socket socket_;
  std::optional<std::uint64_t> expected_;
  std::jthread thread_;
};

}  // namespace

std::unique_ptr<Source> receive_stream(const std::string& place, History& history) {
  return std::make_unique<ReceivedStream>(place, history);
}

}  // namespace breakaway::watch
