#pragma once
/// Threads that run jobs of one kind, each one after the other.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace luxrig {

/// A connection waits for its answer, so the queue is never longer than the number of connections.
class Lane {
 public:
  Lane(int threads, bool low_priority);
  ~Lane() { stop(); }
  void push(std::function<void()> job);
  /// Drops queued jobs and waits for running ones.
  void stop();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> jobs_;
  bool stopped_ = false;
  std::vector<std::thread> threads_;
};

/// Of the calling thread: Linux keeps the nice value per thread.
void lower_priority();

}  // namespace luxrig
