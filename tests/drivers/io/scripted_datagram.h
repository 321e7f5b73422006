#pragma once
/// A datagram channel without a network: it records sent datagrams and returns scripted ones.

#include <deque>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "drivers/io/datagram.h"

namespace luxrig {

/// State shared by test and channel; the driver owns the channel and may destroy it.
struct DatagramScript {
  struct Sent {
    SocketAddress to;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Sent> sent;
  std::set<std::uint32_t> joined;
  std::deque<Datagram> incoming;
  std::deque<Fault> errors;         ///< for take_error()
  std::optional<Fault> send_fails;  ///< every send() fails with this while set
  std::optional<Fault> open_fails;  ///< every open() fails with this while set
  bool open = false;
  int opened = 0;
};

class ScriptedDatagram final : public DatagramChannel {
 public:
  explicit ScriptedDatagram(std::shared_ptr<DatagramScript> script) : script_(std::move(script)) {}

  Result<void> open() override {
    if (script_->open_fails) return tl::unexpected(*script_->open_fails);
    script_->open = true;
    ++script_->opened;
    return {};
  }
  void close() override { script_->open = false; }
  bool is_open() const override { return script_->open; }
  Result<void> send(const SocketAddress& to, std::span<const std::uint8_t> bytes) override {
    if (script_->send_fails) return tl::unexpected(*script_->send_fails);
    script_->sent.push_back({to, {bytes.begin(), bytes.end()}});
    return {};
  }
  Result<void> join(std::uint32_t group) override {
    script_->joined.insert(group);
    return {};
  }
  std::optional<Fault> take_error() override {
    if (script_->errors.empty()) return std::nullopt;
    Fault fault = script_->errors.front();
    script_->errors.pop_front();
    return fault;
  }
  std::optional<Datagram> receive() override {
    if (script_->incoming.empty()) return std::nullopt;
    Datagram datagram = std::move(script_->incoming.front());
    script_->incoming.pop_front();
    return datagram;
  }

 private:
  std::shared_ptr<DatagramScript> script_;
};

}  // namespace luxrig
