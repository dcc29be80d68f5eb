#include "breakaway/watch/server.hpp"

#include <fmt/format.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <future>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "page.hpp"

namespace breakaway::watch {
namespace {

using Json = nlohmann::json;
using httplib::Request;
using httplib::Response;

// With the character set httplib does not compress it, which would cost more time than the way within a machine.
constexpr const char* json_type = "application/json; charset=utf-8";
constexpr std::array fields{"axis",       "time_s",     "target_m",        "position_m", "command_N",
                            "reported_N", "latency_us", "bus_load",        "mode",       "drive",
                            "fault",      "fault_code", "stop_not_obeyed", "link_lost"};

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw InputError{
        "this system gives no random numbers, without which nothing may be commanded; leave --control out"};
  std::string text;
  for (const auto byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

// In a time that does not tell how far the two agree.
bool equal_secrets(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(b[i]));
  return difference == 0;
}

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

// As it stands in an address line.
std::string in_url(const std::string& address) {
  return address.find(':') == address.npos ? address : "[" + address + "]";
}

// The names of an enumeration by their numbers.
template <class Enum>
Json names() {
  Json all = Json::array();
  for (std::int64_t number = 0; const auto value = enumerator<Enum>(number); ++number)
    all.push_back(std::string{to_string(*value)});
  return all;
}

// 0: it is no socket of TCP.
int local_port(int descriptor) {
  int type = 0;
  socklen_t type_size = sizeof type;
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_STREAM) return 0;
  sockaddr_storage bytes{};
  socklen_t size = sizeof bytes;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&bytes), &size);
  if (bytes.ss_family != AF_INET && bytes.ss_family != AF_INET6) return 0;
  // The port stands at the same place for both families.
  sockaddr_in four{};
  std::memcpy(&four, &bytes, sizeof four);
  return ntohs(four.sin_port);
}

void append_real(std::string& row, double number) {
  if (std::isfinite(number))
    fmt::format_to(std::back_inserter(row), ",{}", number);
  else
    row += ",null";
}

template <class Enum>
void append_number(std::string& row, const std::optional<Enum>& value) {
  fmt::format_to(std::back_inserter(row), ",{}", value ? static_cast<int>(*value) : -1);
}

void append_row(std::string& text, const Sample& s, const std::vector<std::string>& axes) {
  const auto place = std::ranges::find(axes, s.axis) - axes.begin();
  fmt::format_to(std::back_inserter(text), "[{}", place);
  for (const double number : {s.time_s, s.target_m, s.position_m, s.command_N, s.reported_N, s.latency_us, s.bus_load})
    append_real(text, number);
  append_number(text, s.mode);
  append_number(text, s.drive);
  append_number(text, s.fault);
  fmt::format_to(std::back_inserter(text), ",{},{},{}]", s.fault_code, int{s.stop_not_obeyed}, int{s.link_lost});
}

std::string to_json(const Excerpt& excerpt) {
  const Json rest{{"next", excerpt.next},
                  {"more", excerpt.more},
                  {"axes", excerpt.axes},
                  {"malformed", excerpt.losses.malformed},
                  {"lost_on_the_way", excerpt.losses.on_the_way},
                  {"lost_at_sender", excerpt.losses.at_sender},
                  {"complaint", excerpt.losses.complaint}};
  std::string text = rest.dump(-1, ' ', true, Json::error_handler_t::replace);
  text.pop_back();
  text += ",\"rows\":[";
  for (bool first = true; const Sample& sample : excerpt.samples) {
    if (!std::exchange(first, false)) text += ',';
    append_row(text, sample, excerpt.axes);
  }
  return text + "]}";
}

}  // namespace

class Server::Implementation {
 public:
  Implementation(const ServerOptions& options, const History& history, std::optional<Operator> the_operator)
      : options_{options},
        history_{history},
        operator_{std::move(the_operator)},
        token_{operator_ ? random_token() : std::string{}} {
    configure();
    listen();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation() {
    server_.stop();
    while (ended_.wait_for(std::chrono::milliseconds{10}) != std::future_status::ready) hang_up();
  }

  int port() const { return options_.port; }
  std::string url() const {
    return fmt::format("http://{}:{}/{}", in_url(options_.bind), options_.port, operator_ ? "#token=" + token_ : "");
  }

 private:
  void configure() {
    // Not SO_REUSEPORT, which would let two servers share a port and so hide that it is taken.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    // Each open connection keeps a thread until it has been silent for a second: pages that were left open keep none.
    constexpr std::size_t longest_request = 4096, threads = 64;
    constexpr time_t longest_silence_s = 1;
    server_.set_payload_max_length(longest_request);
    server_.set_read_timeout(longest_silence_s);
    server_.set_keep_alive_timeout(longest_silence_s);
    server_.new_task_queue = [] { return new httplib::ThreadPool{threads}; };
    server_.set_default_headers({{"Content-Security-Policy",
                                  "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
                                  "img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"},
                                 {"Cache-Control", "no-store"}});
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      if (is_our_host(request)) return httplib::Server::HandlerResponse::Unhandled;
      refuse(response, 403, "this is no name of this machine; open the address that breakaway watch has printed");
      return httplib::Server::HandlerResponse::Handled;
    });
    for (const auto& entry : page_files())
      server_.Get(entry.first, [file = entry.second](const Request&, Response& response) {
        response.set_content(file.content.data(), file.content.size(), file.type);
      });
    server_.Get("/about", [this](const Request&, Response& response) { response.set_content(about(), json_type); });
    server_.Get("/samples", [this](const Request& request, Response& response) { samples(request, response); });
    server_.Post("/command", [this](const Request& request, Response& response) { command(request, response); });
  }

  void listen() {
    errno = 0;
    const int chosen = options_.port == 0                                   ? server_.bind_to_any_port(options_.bind)
                       : server_.bind_to_port(options_.bind, options_.port) ? options_.port
                                                                            : -1;
    if (chosen <= 0)
      throw InputError{fmt::format(
          "http://{}:{}: cannot be listened on{}; --http PORT names another port, 0 any free one, and --bind an "
          "address "
          "of this machine",
          in_url(options_.bind), options_.port, errno == 0 ? "" : fmt::format(": {}", std::strerror(errno)))};
    options_.port = chosen;
    ended_ = std::async(std::launch::async, [this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }

  // However slowly a client speaks or listens, the end does not wait for it. httplib does not name the connections that
  // it has accepted: they are the sockets of this process on our port.
  void hang_up() const {
    for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/fd"}) {
      const int descriptor = std::stoi(entry.path().filename().string());
      if (local_port(descriptor) == options_.port) shutdown(descriptor, SHUT_RDWR);
    }
  }

  static void refuse(Response& response, int status, const std::string& why) {
    response.status = status;
    response.set_content(Json{{"refused", why}}.dump(), json_type);
  }

  bool is_our_host(const Request& request) const {
    if (!is_loopback(options_.bind)) return true;  // whoever opens it to others chooses their names for it
    const std::string host = request.get_header_value("Host");
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"})
      if (host == fmt::format("{}:{}", name, options_.port)) return true;
    return host == fmt::format("{}:{}", in_url(options_.bind), options_.port);
  }

  // A browser says from which page a request comes that may change something.
  static bool is_our_page(const Request& request) {
    return !request.has_header("Origin") ||
           request.get_header_value("Origin") == "http://" + request.get_header_value("Host");
  }

  bool is_the_operators(const Request& request) const {
    return operator_ && is_our_page(request) && equal_secrets(request.get_header_value("X-Breakaway-Token"), token_);
  }

  std::string about() const {
    return Json{{"description", options_.description},
                {"live", options_.live},
                {"axes", options_.axes},
                {"control", operator_.has_value()},
                {"fields", fields},
                {"modes", names<law::Mode>()},
                {"drives", names<hal::DriveState>()},
                {"faults", names<firmware::AxisFault>()}}
        .dump(-1, ' ', true, Json::error_handler_t::replace);
  }

  void samples(const Request& request, Response& response) const {
    constexpr std::size_t most = 20'000, most_digits = 18;
    const std::string from = request.has_param("from") ? request.get_param_value("from") : "0";
    if (from.empty() || from.size() > most_digits || from.find_first_not_of("0123456789") != from.npos)
      return refuse(response, 400, "from is not the number of a sample");
    if (is_the_operators(request)) operator_->is_there();
    response.set_content(to_json(history_.read(std::stoull(from), most)), json_type);
  }

  void command(const Request& request, Response& response) const {
    if (!operator_)
      return refuse(response, 403, "nothing is commanded from here; start breakaway watch with --can and --control");
    if (!is_the_operators(request))
      return refuse(response, 403,
                    "the token is not the one of this run; open the address that breakaway watch has printed");
    const auto wanted = read_command(request.body);
    if (!wanted)
      return refuse(
          response, 400,
          "a command is {\"axis\": place, \"action\": \"enable\", \"stop\", \"target\" or \"reset\"}, and for a "
          "target \"target_m\"");
    if (const std::string why_not = operator_->obey(*wanted); !why_not.empty()) return refuse(response, 409, why_not);
    response.set_content("{}", json_type);
  }

  ServerOptions options_;
  const History& history_;
  std::optional<Operator> operator_;
  std::string token_;
  httplib::Server server_;
  std::future<void> ended_;  // of the thread that listens
};

Server::Server(const ServerOptions& options, const History& history, std::optional<Operator> the_operator)
    : implementation_{std::make_unique<Implementation>(options, history, std::move(the_operator))} {}
Server::~Server() = default;
int Server::port() const { return implementation_->port(); }
std::string Server::url() const { return implementation_->url(); }

}  // namespace breakaway::watch
