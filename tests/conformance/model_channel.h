#pragma once
/// A USB channel whose far end is a simulated widget in the same process, under a stepped clock. Waiting moves the
/// clock on, so a test sees microseconds that no real machine would keep.

#include <algorithm>
#include <deque>
#include <map>

#include "drivers/usb/usb_channel.h"
#include "sim/devices/usb/usb_device.h"

namespace luxrig {

/// The cable and its faults; outlives the channel.
struct ModelCable {
  explicit ModelCable(sim::UsbDevice& the_device) : device(the_device) { device.power_on(now); }
  sim::UsbDevice& device;
  Time now = Time{} + std::chrono::seconds(1000);
  bool plugged_in = true;
  int stalls = 0, hangs = 0, failures = 0;  ///< number of next outgoing transfers that do so
  std::vector<UsbSetup> requests;           ///< outgoing control transfers that were begun
  std::vector<std::size_t> bulk_out;        ///< bytes of each transfer
  int opened = 0, closed = 0;
};

class ModelChannel final : public UsbChannel {
 public:
  explicit ModelChannel(ModelCable& cable) : cable_(cable) {}

  Result<void> open() override {
    if (!cable_.plugged_in) return tl::unexpected(Fault{Cause::network, {}, "not plugged in", {}});
    open_ = true;
    ++cable_.opened;
    return {};
  }
  void close() override {
    if (open_) ++cable_.closed;
    open_ = false;
    queues_.clear();
    ended_.clear();
  }
  [[nodiscard]] bool is_open() const override { return open_; }
  [[nodiscard]] std::string where() const override { return open_ ? "model" : ""; }

  UsbTicket control_out(const UsbSetup& setup, std::span<const std::uint8_t> data) override {
    return start(0, setup, {data.begin(), data.end()}, data.size());
  }
  UsbTicket control_in(const UsbSetup& setup, std::size_t length) override { return start(0, setup, {}, length); }
  UsbTicket bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data) override {
    return start(endpoint, {}, {data.begin(), data.end()}, data.size());
  }
  UsbTicket bulk_in(std::uint8_t endpoint, std::size_t length) override { return start(endpoint, {}, {}, length); }

  void cancel(UsbTicket ticket) override {
    for (auto& [endpoint, queue] : queues_) {
      if (std::erase_if(queue, [&](const Transfer& t) { return t.ticket == ticket; }) > 0) {
        ended_.push_back({ticket, UsbStatus::cancelled, 0, {}});
      }
    }
  }

  std::optional<UsbCompletion> take(std::chrono::milliseconds wait) override {
    run();
    for (const Time until = cable_.now + wait; ended_.empty() && cable_.now < until; run()) {
      cable_.now += std::chrono::microseconds(100);
    }
    if (ended_.empty()) return std::nullopt;
    UsbCompletion completion = std::move(ended_.front());
    ended_.pop_front();
    return completion;
  }

 private:
  struct Transfer {
    UsbTicket ticket = 0;
    UsbSetup setup;
    std::vector<std::uint8_t> out;
    std::size_t length = 0;
    std::optional<sim::UsbReply> reply;
    bool hangs = false, fails = false;
    Time due{};
  };

  UsbTicket start(int endpoint, const UsbSetup& setup, std::vector<std::uint8_t> out, std::size_t length) {
    queues_[endpoint].push_back({++last_, setup, std::move(out), length, {}, false, false, {}});
    run();
    return last_;
  }

  void run() {
    for (auto& [endpoint, queue] : queues_) {
      while (!queue.empty()) {
        Transfer& transfer = queue.front();
        if (!cable_.plugged_in) {
          ended_.push_back({transfer.ticket, UsbStatus::gone, 0, {}});
          queue.pop_front();
          continue;
        }
        if (!transfer.reply && !transfer.hangs) begin(endpoint, transfer);
        if (!transfer.reply || transfer.due > cable_.now) break;
        const bool good = transfer.reply->kind == sim::UsbReply::Kind::done;
        const bool in = !transfer.reply->data.empty();
        UsbStatus status = good ? UsbStatus::done : UsbStatus::stalled;
        if (transfer.fails) status = UsbStatus::failed;
        ended_.push_back({transfer.ticket, status, in ? transfer.reply->data.size() : transfer.reply->taken,
                          std::move(transfer.reply->data)});
        queue.pop_front();
      }
    }
  }

  void begin(int endpoint, Transfer& transfer) {
    const bool in = (endpoint & 0x80) != 0 || (endpoint == 0 && (transfer.setup.request_type & 0x80) != 0);
    if (!in && cable_.hangs > 0) {
      --cable_.hangs;
      transfer.hangs = true;
      return;
    }
    sim::UsbReply reply;
    if (!in && cable_.stalls > 0) {
      --cable_.stalls;
      reply.kind = sim::UsbReply::Kind::stall;
    } else if (!in && cable_.failures > 0) {
      --cable_.failures;
      transfer.fails = true;
    } else if (endpoint == 0) {
      const UsbSetup& s = transfer.setup;
      if (!in) cable_.requests.push_back(s);
      reply = cable_.device.control(
          cable_.now, {s.request_type, s.request, s.value, s.index, static_cast<std::uint16_t>(transfer.length)},
          transfer.out);
    } else if (in) {
      reply = cable_.device.bulk_in(cable_.now, endpoint, transfer.length);
      if (reply.kind == sim::UsbReply::Kind::wait) return;
    } else {
      cable_.bulk_out.push_back(transfer.out.size());
      reply = cable_.device.bulk_out(cable_.now, endpoint, transfer.out);
    }
    transfer.due = cable_.now + reply.takes;
    transfer.reply = std::move(reply);
  }

  ModelCable& cable_;
  bool open_ = false;
  UsbTicket last_ = 0;
  std::map<int, std::deque<Transfer>> queues_;
  std::deque<UsbCompletion> ended_;
};

}  // namespace luxrig
