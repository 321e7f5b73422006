#include "tools/luxrigd/teller.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace luxrig {
namespace {

constexpr std::size_t kMaxLines = 1000;
constexpr auto kAtTheEnd = std::chrono::seconds(1);

void write_or_lose(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (n >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

struct Teller::Shared {
  explicit Shared(int to) : fd(to) {}
  const int fd;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::string> lines;
  std::size_t lost = 0;
  bool writing = false, over = false;

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return over || !lines.empty(); });
      if (lines.empty()) return;
      std::string text = std::move(lines.front());
      lines.pop_front();
      if (lost > 0) text += fmt::format("({} lines before were not read in time, and are lost)\n", std::exchange(lost, 0));
      writing = true;
      lock.unlock();
      write_or_lose(fd, text);
      lock.lock();
      writing = false;
      changed.notify_all();
    }
  }
};

Teller::Teller(int fd) : shared_(std::make_shared<Shared>(fd)) {
  std::thread([shared = shared_] { shared->run(); }).detach();
}

Teller::~Teller() {
  flush(kAtTheEnd);
  const std::lock_guard lock(shared_->mutex);
  shared_->over = true;
  shared_->lines.clear();
  shared_->changed.notify_all();
}

void Teller::tell(std::string text) {
  const std::lock_guard lock(shared_->mutex);
  if (shared_->lines.size() == kMaxLines) {
    shared_->lines.pop_front();
    ++shared_->lost;
  }
  shared_->lines.push_back(std::move(text));
  shared_->changed.notify_all();
}

bool Teller::flush(Duration at_most) {
  std::unique_lock lock(shared_->mutex);
  return shared_->changed.wait_for(lock, at_most, [&] { return shared_->lines.empty() && !shared_->writing; });
}

}  // namespace luxrig
