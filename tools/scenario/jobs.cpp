#include "tools/scenario/jobs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tools/scenario/outcome_text.h"

namespace luxrig::scenario {
namespace {

struct Worker {
  pid_t pid = -1;
  int pipe = -1;
  std::string text;  ///< a line of JSON per outcome
};

void write_all(int file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t wrote = ::write(file, text.data() + at, text.size() - at);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) ::_exit(1);
    at += static_cast<std::size_t>(wrote);
  }
}

}  // namespace

std::vector<Outcome> run_all(std::size_t count, int jobs, const std::function<Outcome(std::size_t)>& run,
                             const std::function<void(std::size_t)>& done) {
  std::vector<Outcome> outcomes(count);
  std::size_t finished = 0;
  const auto take = [&](std::size_t index, Outcome outcome) {
    outcomes[index] = std::move(outcome);
    if (done) done(++finished);
  };
  const auto workers_wanted = std::min<std::size_t>(static_cast<std::size_t>(std::max(1, jobs)), count);
  if (workers_wanted <= 1) {
    for (std::size_t i = 0; i < count; ++i) take(i, run(i));
    return outcomes;
  }
  for (Outcome& outcome : outcomes) outcome.error = "its process died";
  std::vector<Worker> workers;
  for (std::size_t w = 0; w < workers_wanted; ++w) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) break;  // what a run starts must not hold it open
    const pid_t pid = ::fork();
    if (pid == 0) {
      ::close(ends[0]);
      // Taken in turns: neighbouring seeds take about as long.
      for (std::size_t i = w; i < count; i += workers_wanted)
        write_all(ends[1], nlohmann::json{{"index", i}, {"outcome", to_json(run(i))}}.dump(
                               -1, ' ', false, nlohmann::json::error_handler_t::replace) +
                               "\n");
      ::_exit(0);
    }
    ::close(ends[1]);
    if (pid < 0) {
      ::close(ends[0]);
      break;
    }
    workers.push_back({pid, ends[0], {}});
  }
  if (workers.size() < workers_wanted)
    for (std::size_t w = workers.size(); w < workers_wanted; ++w)
      for (std::size_t i = w; i < count; i += workers_wanted) take(i, run(i));
  for (std::size_t open = workers.size(); open > 0;) {
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers) waiting.push_back({worker.pipe, POLLIN, 0});  // -1 is ignored
    if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) break;
    for (std::size_t w = 0; w < workers.size(); ++w) {
      if (waiting[w].fd < 0 || waiting[w].revents == 0) continue;
      char buffer[1 << 16];
      const ssize_t got = ::read(waiting[w].fd, buffer, sizeof buffer);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) {
        ::close(waiting[w].fd);
        workers[w].pipe = -1;
        --open;
        continue;
      }
      std::string& text = workers[w].text;
      text.append(buffer, static_cast<std::size_t>(got));
      for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
        const auto line = nlohmann::json::parse(text.substr(0, end), nullptr, false);
        text.erase(0, end + 1);
        if (!line.is_discarded()) take(line["index"], outcome_of(line["outcome"]));
      }
    }
  }
  for (const Worker& worker : workers) ::waitpid(worker.pid, nullptr, 0);
  return outcomes;
}

}  // namespace luxrig::scenario
