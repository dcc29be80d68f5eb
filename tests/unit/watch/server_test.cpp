#include "breakaway/watch/server.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "../refusal.hpp"

namespace {

using namespace breakaway::watch;
using breakaway::testing::refusal;
using nlohmann::json;

class WatchServer : public ::testing::Test {
 protected:
  // Serves on a free port.
  void serve(const std::optional<Operator>& the_operator = {}) {
    server_ = std::make_unique<Server>(ServerOptions{.port = 0, .description = "a test", .live = true}, history_,
                                       the_operator);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", server_->port());
  }
  void serve_commands() {
    serve(Operator{.obey =
                       [this](const Command& command) {
                         obeyed_.push_back(command);
                         return answer_;
                       },
                   .is_there = [this] { ++seen_; }});
    const std::string url = server_->url();
    token_ = url.substr(url.find("#token=") + 7);
  }
  json get(const std::string& path) {
    const auto response = client_->Get(path);
    EXPECT_TRUE(response) << path;
    return response ? json::parse(response->body) : json{};
  }
  int status(const std::string& path, const httplib::Headers& headers = {}) {
    const auto response = client_->Get(path, headers);
    return response ? response->status : -1;
  }
  int command(const std::string& body, const httplib::Headers& headers) {
    const auto response = client_->Post("/command", headers, body, "application/json");
    return response ? response->status : -1;
  }
  httplib::Headers with_token() const { return {{"X-Breakaway-Token", token_}}; }

  History history_;
  std::vector<Command> obeyed_;
  int seen_ = 0;
  std::string answer_, token_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(WatchServer, ServesThePageAndWhatItNeedsOfItself) {
  serve();
  const auto page = client_->Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("<title>breakaway watch</title>"), std::string::npos);
  for (const char* file : {"/watch.js", "/chart.js", "/watch.css"}) {
    const auto response = client_->Get(file);
    ASSERT_TRUE(response);
    EXPECT_EQ(response->status, 200) << file;
    EXPECT_FALSE(response->body.empty()) << file;
    EXPECT_EQ(response->body.find("http://"), std::string::npos) << file << " must do without a network";
    EXPECT_EQ(response->body.find("https://"), std::string::npos) << file;
  }
  EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
}

TEST_F(WatchServer, SaysWhatIsWatchedAndWhatTheNumbersMean) {
  serve();
  const json about = get("/about");
  EXPECT_EQ(about.at("description"), "a test");
  EXPECT_EQ(about.at("control"), false);
  EXPECT_EQ(about.at("fields")[3], "position_m");
  EXPECT_EQ(about.at("modes"), (json{"approach", "kick", "coast", "hold", "fault"}));
  EXPECT_EQ(about.at("drives")[3], "enabled");
  EXPECT_EQ(about.at("faults").back(), "external motion");
}

TEST_F(WatchServer, GivesSamplesAsRowsFromANumberOn) {
  history_.add({.axis = "x", .time_s = 1, .position_m = 0.25, .mode = breakaway::law::Mode::kick});
  history_.add({.axis = "y", .time_s = 2, .position_m = 0.5});
  history_.complain("a \"bad\" line \xFF");
  serve();
  const json all = get("/samples?from=0");
  EXPECT_EQ(all.at("next"), 2);
  EXPECT_EQ(all.at("more"), false);
  EXPECT_EQ(all.at("axes"), (json{"x", "y"}));
  EXPECT_EQ(all.at("malformed"), 1);
  const json fields = get("/about").at("fields");
  ASSERT_EQ(all.at("rows").size(), 2U);
  ASSERT_EQ(all["rows"][0].size(), fields.size());
  EXPECT_EQ(all["rows"][0], (json{0, 1.0, nullptr, 0.25, nullptr, nullptr, nullptr, nullptr, 1, -1, -1, 0, 0, 0}));
  EXPECT_EQ(get("/samples?from=1").at("rows").size(), 1U);
  EXPECT_EQ(get("/samples?from=2").at("rows").size(), 0U);
  EXPECT_EQ(get("/samples").at("rows").size(), 2U);
}

TEST_F(WatchServer, GivesALongRunInParts) {
  for (int n = 0; n < 50'000; ++n) history_.add({.axis = "", .time_s = 1e-3 * n, .position_m = 0});
  serve();
  std::size_t rows = 0;
  for (json part{{"next", 0}, {"more", true}}; part.at("more").get<bool>(); rows += part.at("rows").size())
    part = get(fmt::format("/samples?from={}", part.at("next").get<int>()));
  EXPECT_EQ(rows, 50'000U);
}

TEST_F(WatchServer, DoesNotCompressSamples) {
  for (int n = 0; n < 1000; ++n) history_.add({.axis = "", .time_s = 1e-3 * n, .position_m = 0});
  serve();
  const auto answer = client_->Get("/samples", {{"Accept-Encoding", "gzip, deflate, br"}});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->get_header_value("Content-Encoding"), "") << "a machine that controls has better to do";
}

TEST_F(WatchServer, NoOtherPathIsThere) {
  serve();
  for (const char* path : {"/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/watch.js/..",
                           "/index.html", "/page/watch.js", "/about/", "/command"})
    EXPECT_EQ(status(path), 404) << path;
  for (const char* from : {"-1", "1e3", "x", "", "9999999999999999999999", "1%00", "0;ls"})
    EXPECT_EQ(status(std::string{"/samples?from="} + from), 400) << from;
}

TEST_F(WatchServer, AnswersToThisMachinesNamesOnly) {
  serve();
  const auto asked = [&](const std::string& host) { return status("/about", {{"Host", host}}); };
  const int port = server_->port();
  EXPECT_EQ(asked(fmt::format("127.0.0.1:{}", port)), 200);
  EXPECT_EQ(asked(fmt::format("localhost:{}", port)), 200);
  EXPECT_EQ(asked(fmt::format("rebound.example:{}", port)), 403);
  EXPECT_EQ(asked("127.0.0.1"), 403);
  EXPECT_EQ(asked(fmt::format("127.0.0.1:{}", port + 1)), 403);
}

TEST_F(WatchServer, APortThatIsTakenIsRefusedByName) {
  serve();
  const auto refused = refusal([&] { Server{{.port = server_->port()}, history_, {}}; });
  EXPECT_NE(refused.find(fmt::format("http://127.0.0.1:{}: cannot be listened on", server_->port())), std::string::npos)
      << refused;
  EXPECT_NE(refused.find("--http PORT names another port"), std::string::npos);
  EXPECT_NE(refusal([&] {
              Server{{.bind = "203.0.113.7", .port = 0}, history_, {}};
            }).find("--bind"),
            std::string::npos);
}

// It sends a byte each tenth of a second, of a header without end.
class SlowClient {
 public:
  explicit SlowClient(int port) : socket_{socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_TRUE(says("GET / HTTP/1.1\r\nX: "));
    speaks_ = std::jthread{[this](const std::stop_token& stop) {
      while (!stop.stop_requested() && says("a")) std::this_thread::sleep_for(std::chrono::milliseconds{100});
    }};
  }
  SlowClient(const SlowClient&) = delete;
  SlowClient& operator=(const SlowClient&) = delete;
  ~SlowClient() {
    speaks_ = {};
    close(socket_);
  }

 private:
  bool says(std::string_view text) const {
    return send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }

  int socket_;
  std::jthread speaks_;
};

TEST_F(WatchServer, EndsWhileClientsStillSpeak) {
  serve();
  std::vector<std::unique_ptr<SlowClient>> clients;
  for (int n = 0; n < 3; ++n) clients.push_back(std::make_unique<SlowClient>(server_->port()));
  EXPECT_EQ(status("/about"), 200);
  auto ended = std::async(std::launch::async, [this] { server_.reset(); });
  EXPECT_EQ(ended.wait_for(std::chrono::seconds{60}), std::future_status::ready);
  clients.clear();  // or the test would not end either
}

TEST_F(WatchServer, NothingIsCommandedUnlessItWasStartedForThat) {
  serve();
  EXPECT_EQ(server_->url().find('#'), std::string::npos);
  EXPECT_EQ(command(R"({"axis":0,"action":"stop"})", {{"X-Breakaway-Token", ""}}), 403);
}

TEST_F(WatchServer, TakesACommandWithTheTokenFromItsOwnPage) {
  serve_commands();
  EXPECT_EQ(token_.size(), 32U);
  EXPECT_EQ(get("/about").at("control"), true);
  EXPECT_EQ(command(R"({"axis":2,"action":"target","target_m":-0.25})", with_token()), 200);
  auto from_page = with_token();
  from_page.emplace("Origin", fmt::format("http://127.0.0.1:{}", server_->port()));
  EXPECT_EQ(command(R"({"axis":0,"action":"reset"})", from_page), 200);
  ASSERT_EQ(obeyed_.size(), 2U);
  EXPECT_EQ(obeyed_[0].axis, 2U);
  EXPECT_EQ(obeyed_[0].action, Action::target);
  EXPECT_EQ(obeyed_[0].target_m, -0.25);
  EXPECT_EQ(obeyed_[1].action, Action::reset);
  answer_ = "another commander is on the bus";
  const auto refused = client_->Post("/command", with_token(), R"({"axis":0,"action":"enable"})", "application/json");
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, 409);
  EXPECT_EQ(json::parse(refused->body).at("refused"), answer_);
}

TEST_F(WatchServer, RefusesACommandWithoutTheTokenOrFromAnotherPage) {
  serve_commands();
  const std::string body = R"({"axis":0,"action":"enable"})";
  EXPECT_EQ(command(body, {}), 403);
  EXPECT_EQ(command(body, {{"X-Breakaway-Token", ""}}), 403);
  EXPECT_EQ(command(body, {{"X-Breakaway-Token", std::string(32, '0')}}), 403);
  EXPECT_EQ(command(body, {{"X-Breakaway-Token", token_ + "0"}}), 403);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"}) {
    auto foreign = with_token();
    foreign.emplace("Origin", origin);
    EXPECT_EQ(command(body, foreign), 403) << origin;
  }
  EXPECT_TRUE(obeyed_.empty());
  Server other{{.port = 0}, history_, Operator{}};
  EXPECT_EQ(other.url().find(token_), std::string::npos) << "each run has a token of its own";
}

TEST_F(WatchServer, KnowsThatTheOperatorsPageIsThereByItsToken) {
  serve_commands();
  EXPECT_EQ(status("/samples"), 200);
  EXPECT_EQ(status("/samples", {{"X-Breakaway-Token", std::string(32, '0')}}), 200);
  EXPECT_EQ(seen_, 0);
  EXPECT_EQ(status("/samples", with_token()), 200);
  EXPECT_EQ(seen_, 1);
}

TEST_F(WatchServer, RefusesWhatIsNoCommand) {
  serve_commands();
  for (const char* body :
       {"", "{", "[]", "{}", R"({"axis":0})", R"({"action":"stop"})", R"({"axis":-1,"action":"stop"})",
        R"({"axis":"0","action":"stop"})", R"({"axis":0,"action":"fly"})", R"({"axis":0,"action":7})",
        R"({"axis":0,"action":"target"})", R"({"axis":0,"action":"target","target_m":"0"})",
        R"({"axis":0,"action":"target","target_m":1e999})"})
    EXPECT_EQ(command(body, with_token()), 400) << body;
  EXPECT_EQ(command(std::string(1'000'000, ' '), with_token()), 413);
  EXPECT_TRUE(obeyed_.empty());
}

}  // namespace
