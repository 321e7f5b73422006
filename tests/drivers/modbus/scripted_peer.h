#pragma once
/// A TCP server on an ephemeral loopback port that answers Modbus requests as scripted by a test, right or wrong.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace luxrig {

struct ScriptedAnswer {
  std::vector<std::uint8_t> bytes;
  std::chrono::milliseconds before{0};   ///< pause before the first byte
  std::chrono::milliseconds between{0};  ///< pause between bytes; 0 = all at once
  bool close = false;                    ///< afterwards
};

class ScriptedPeer {
 public:
  using Script = std::function<ScriptedAnswer(const std::vector<std::uint8_t>& request)>;

  explicit ScriptedPeer(Script script, int port = 0) : script_(std::move(script)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 || ::listen(listener_, 8) != 0) {
      throw std::runtime_error("no loopback port");
    }
    socklen_t size = sizeof(address);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    stop_ = ::eventfd(0, EFD_CLOEXEC);
    thread_ = std::thread([this] { run(); });
  }
  ~ScriptedPeer() {
    const std::uint64_t one = 1;
    stopping_ = true;
    [[maybe_unused]] const auto written = ::write(stop_, &one, sizeof(one));
    thread_.join();
    ::close(listener_);
    ::close(stop_);
  }
  ScriptedPeer(const ScriptedPeer&) = delete;
  ScriptedPeer& operator=(const ScriptedPeer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] int connections() const { return connections_; }
  [[nodiscard]] int closed() const { return closed_; }  ///< closed by itself, after an answer
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  void set_script(Script script) {
    const std::lock_guard lock(mutex_);
    script_ = std::move(script);
  }

 private:
  /// False when the peer should stop.
  bool pause(std::chrono::milliseconds time) const {
    pollfd wait{stop_, POLLIN, 0};
    return ::poll(&wait, 1, static_cast<int>(time.count())) == 0;
  }

  void run() {
    int client = -1;
    std::vector<std::uint8_t> buffer;
    const auto drop = [&] {
      if (client >= 0) ::close(client);
      client = -1;
      buffer.clear();
    };
    while (!stopping_) {
      pollfd wait[3] = {{stop_, POLLIN, 0}, {listener_, POLLIN, 0}, {client, POLLIN, 0}};
      ::poll(wait, 3, -1);
      if (stopping_) break;
      if (wait[1].revents != 0) {
        drop();  // one connection at a time: the newest counts
        client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
        const int at_once = 1;  // a second answer must not wait for the first's acknowledgement
        ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof(at_once));
        ++connections_;
        continue;
      }
      std::uint8_t bytes[512];
      const auto got = ::recv(client, bytes, sizeof(bytes), 0);
      if (got <= 0) {
        drop();
        continue;
      }
      buffer.insert(buffer.end(), bytes, bytes + got);
      while (client >= 0 && buffer.size() >= 6 && buffer.size() >= 6u + (buffer[4] << 8 | buffer[5])) {
        const std::size_t size = 6u + (buffer[4] << 8 | buffer[5]);
        const std::vector<std::uint8_t> request(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
        buffer.erase(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
        Script script;
        {
          const std::lock_guard lock(mutex_);
          requests_.push_back(request);
          script = script_;
        }
        const ScriptedAnswer answer = script(request);
        if (answer.before.count() > 0 && !pause(answer.before)) break;
        if (answer.between.count() == 0) {
          ::send(client, answer.bytes.data(), answer.bytes.size(), MSG_NOSIGNAL);
        } else {
          for (const std::uint8_t byte : answer.bytes) {
            if (::send(client, &byte, 1, MSG_NOSIGNAL) != 1 || !pause(answer.between)) break;
          }
        }
        if (answer.close) {
          drop();
          ++closed_;
        }
      }
    }
    drop();
  }

  Script script_;
  int listener_ = -1, stop_ = -1, port_ = 0;
  std::atomic<int> connections_{0}, closed_{0};
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::vector<std::vector<std::uint8_t>> requests_;
  std::thread thread_;
};

}  // namespace luxrig
