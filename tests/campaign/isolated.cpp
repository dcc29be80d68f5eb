#include "isolated.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace breakaway::campaign {
namespace {

[[noreturn]] void answer(int pipe, const std::function<Judgement()>& judge) {
  std::string text;
  try {
    const Judgement result = judge();
    text = std::to_string(static_cast<int>(result.finding)) + " " + std::to_string(result.error * 1e30) + " " +
           result.note;
  } catch (const std::exception& error) {
    text = std::to_string(static_cast<int>(Finding::crashed)) + " 0 " + error.what();
  }
  const bool written = write(pipe, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  _exit(written ? 0 : 1);
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 512> part;
  for (ssize_t got = read(pipe, part.data(), part.size()); got > 0; got = read(pipe, part.data(), part.size())) {
    text.append(part.data(), static_cast<std::size_t>(got));
  }
  return text;
}

Judgement parsed(const std::string& text) {
  char* end = nullptr;
  Judgement result;
  result.finding = static_cast<Finding>(std::strtol(text.c_str(), &end, 10));
  result.error = std::strtod(end, &end) * 1e-30;
  result.note = *end == ' ' ? end + 1 : end;
  return result;
}

}  // namespace

Judgement isolated(bool apart, const std::function<Judgement()>& judge) {
  if (!apart) return judge();
  std::array<int, 2> ends;
  if (pipe(ends.data()) != 0) throw std::runtime_error{"no pipe"};
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error{"no process"};
  if (child == 0) answer(ends[1], judge);
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (text.empty()) {
    const bool late = WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
    return {late ? Finding::endless : Finding::crashed, 0, late ? "out of processor time" : "ended by a signal"};
  }
  return parsed(text);
}

}  // namespace breakaway::campaign
