#include "drivers/dmx/rdm/rdm_transaction.h"

#include <fmt/format.h>

#include "core/check.h"

namespace luxrig::rdm {
namespace {

constexpr int kQuestions = 3;
constexpr int kMaxQueued = 32;  // messages about other parameters before the expected one
constexpr std::size_t kMaxCollected = 65536;
constexpr int kMaxRestarts = 2;
constexpr Duration kTimerUnit = std::chrono::milliseconds(100);
// Status types of QUEUED_MESSAGE: repeat the last message; advisories and worse, if there is no message.
constexpr std::uint8_t kLastMessage = 0x01, kAdvisory = 0x02;

int number_16(const std::vector<std::uint8_t>& data) { return data[0] << 8 | data[1]; }

}  // namespace

Transaction::Transaction(Request request, const Uid& controller, std::uint8_t& number, TransactionTiming timing)
    : request_(std::move(request)), controller_(controller), number_(number), timing_(timing) {
  LUXRIG_CHECK(request_.data.size() <= kMaxData, "{} bytes", request_.data.size());
  LUXRIG_CHECK(request_.command_class == CommandClass::get || request_.command_class == CommandClass::set, "class {}",
               static_cast<int>(request_.command_class));
}

std::optional<Packet> Transaction::due(Time now) {
  if (result_) return std::nullopt;
  if (!begun_) begun_ = not_before_ = now;
  if (now - *begun_ > timing_.whole) {
    fail(Cause::timeout, fmt::format("no answer about {} within {:.1f} s: ask again later", text_of(request_.pid),
                                     to_seconds(timing_.whole)));
    return std::nullopt;
  }
  if (sent_) {
    if (now - *sent_ < timing_.answer) return std::nullopt;
    sent_.reset();
    ++lost_;
    if (stage_ == Stage::session_end) {
      next(Stage::question, now);  // the session has ended, or the device hears nothing
    } else if (stage_ == Stage::queue) {
      queue_last_ = true;  // the message has left the queue and is lost unless requested as the last one
    } else if (collecting_) {
      collecting_ = false;
      parts_.clear();
      ++restarts_;
      next(Stage::session_end, now);
    }
    if (lost_ >= kQuestions || restarts_ > kMaxRestarts) {
      fail(Cause::timeout, fmt::format("no answer about {} to {} questions of {:.0f} ms: is it switched on and on this "
                                       "line?",
                                       text_of(request_.pid), kQuestions, 1000 * to_seconds(timing_.answer)));
      return std::nullopt;
    }
  }
  if (now < not_before_) return std::nullopt;
  Packet packet = packet_of(stage_);
  packet.transaction = sent_number_ = ++number_;
  if (is_broadcast(request_.to)) {
    result_ = std::vector<std::uint8_t>{};
  } else {
    sent_ = now;
  }
  return packet;
}

Packet Transaction::packet_of(Stage stage) const {
  Packet packet;
  packet.to = request_.to;
  packet.from = controller_;
  if (stage == Stage::question) {
    packet.command_class = request_.command_class;
    packet.pid = request_.pid;
    packet.data = request_.data;
    packet.sub_device = request_.sub_device;
  } else if (stage == Stage::queue) {
    packet.pid = Pid::queued_message;
    packet.data = {queue_last_ ? kLastMessage : kAdvisory};
  } else {
    packet.pid = request_.pid == Pid::device_info ? Pid::supported_parameters : Pid::device_info;
  }
  return packet;
}

bool Transaction::answers(const Packet& packet) const {
  if (!sent_ || packet.from != request_.to || packet.to != controller_ || packet.transaction != sent_number_) {
    return false;
  }
  if (stage_ == Stage::queue) {
    return packet.command_class == CommandClass::get_response || packet.command_class == CommandClass::set_response;
  }
  const Packet asked = packet_of(stage_);
  return packet.command_class == response_to(asked.command_class) && packet.pid == asked.pid &&
         packet.sub_device == asked.sub_device;
}

void Transaction::hear(Time now, const Packet& packet) {
  if (result_ || !answers(packet)) return;
  sent_.reset();
  lost_ = 0;
  accept(now, packet);
}

void Transaction::accept(Time now, const Packet& packet) {
  if (stage_ == Stage::session_end) return next(Stage::question, now);
  const auto type = static_cast<ResponseType>(packet.port_or_type);
  switch (type) {
    case ResponseType::ack:
    case ResponseType::ack_overflow:
      return take_ack(now, packet);
    case ResponseType::ack_timer: {
      if (packet.data.size() != 2) break;
      const Duration wait = kTimerUnit * number_16(packet.data);
      if (now + wait - *begun_ > timing_.whole) {
        return fail(Cause::timeout, fmt::format("{} takes the device {:.1f} s, more than {:.1f} s: ask again later",
                                                text_of(request_.pid), to_seconds(wait), to_seconds(timing_.whole)));
      }
      return next(Stage::queue, now + wait);
    }
    case ResponseType::nack: {
      if (packet.data.size() != 2) break;
      const auto reason = static_cast<std::uint16_t>(number_16(packet.data));
      // A device without a queue answers so. Then repeat the request itself.
      if (stage_ == Stage::queue && packet.pid == Pid::queued_message) return next(Stage::question, now);
      if (stage_ == Stage::queue && packet.pid != request_.pid) return next(Stage::queue, now);
      return fail(Cause::refused, fmt::format("{}: {}", text_of(request_.pid), text_of_nack(reason)));
    }
  }
  fail(Cause::protocol, fmt::format("answered {} with response type {} and {} bytes, which the standard does not have",
                                    text_of(request_.pid), packet.port_or_type, packet.data.size()));
}

void Transaction::take_ack(Time now, const Packet& packet) {
  if (stage_ == Stage::queue) {
    if (++queue_asked_ > kMaxQueued) {
      return fail(Cause::timeout, fmt::format("no answer about {} among {} queued messages: ask again later",
                                              text_of(request_.pid), kMaxQueued));
    }
    const bool about_it = packet.pid == request_.pid && packet.command_class == response_to(request_.command_class);
    if (!about_it) {
      // A different message was waiting. An empty queue (STATUS_MESSAGES) means that the answer was lost in transit.
      const bool empty = packet.pid == Pid::status_messages && packet.message_count == 0;
      if (empty && queue_last_) return next(Stage::question, now);
      queue_last_ = empty;
      return next(Stage::queue, now);
    }
  }
  if (parts_.size() + packet.data.size() > kMaxCollected) {
    return fail(Cause::protocol, fmt::format("the answer about {} does not end: {} bytes and more",
                                             text_of(request_.pid), kMaxCollected));
  }
  parts_.insert(parts_.end(), packet.data.begin(), packet.data.end());
  if (static_cast<ResponseType>(packet.port_or_type) == ResponseType::ack_overflow) {
    // Get the rest by asking for the parameter itself, even if the answer was queued.
    collecting_ = true;
    return next(Stage::question, now);
  }
  result_ = std::move(parts_);
}

void Transaction::next(Stage stage, Time at) {
  stage_ = stage;
  not_before_ = at;
  if (stage == Stage::question) queue_last_ = false;
}

void Transaction::fail(Cause cause, std::string detail) {
  result_ = tl::unexpected(Fault{cause, text_of(request_.to), std::move(detail), {}});
}

}  // namespace luxrig::rdm
