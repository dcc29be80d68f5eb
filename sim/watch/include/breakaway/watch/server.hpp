// The page and its data over HTTP.
//
//   GET  /               the page, with /watch.js, /chart.js and /watch.css
//   GET  /FAULTS.md      what each fault means and what to do
//   GET  /about          what is watched, and the names of modes, drive states and faults by their numbers
//   GET  /samples?from=N  samples from number N on, as rows in the order of `fields` of /about
//   POST /command        of a controlled node only, see below
//
// Who may ask: every answer is for the machine's own browser. The server is bound to 127.0.0.1 unless another address
// is given, and while it is, it answers only requests whose Host is this machine's, so that no page of another site
// reaches it by a name that it lets point here. No answer may be read by a page of another origin, and a command needs
// the token, which is only in the address that is shown to whoever started the server.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/watch/command.hpp"
#include "breakaway/watch/history.hpp"

namespace breakaway::watch {

struct ServerOptions {
  std::string bind = "127.0.0.1";
  int port = 8080;                  // 0: any free one
  std::string description{};        // of what is watched
  bool live = true;                 // false: a file, which is shown from its beginning
  std::vector<std::string> axes{};  // of a node that is commanded, in its order, as in the samples
};

// What the page's operator may do; any thread calls them.
struct Operator {
  std::function<std::string(const Command&)> obey;  // returns nothing, or why it is not done
  std::function<void()> is_there;                   // a page with the token asks for samples
};

class Server {
 public:
  // Serves from here on until its end. `history` must outlive it. Without an operator nothing can be commanded. Throws
  // InputError: the address cannot be listened on.
  Server(const ServerOptions& options, const History& history, std::optional<Operator> the_operator);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  int port() const;

  // The page's address for whoever may command, with the token.
  std::string url() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace breakaway::watch
