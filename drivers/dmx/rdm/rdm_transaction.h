#pragma once
/// One request to one device until it is answered: `now` and packets in, packets out. Never blocks.
/// Source: ANSI E1.20-2010, chapter 6.
///
/// - ACK_TIMER: waits for the stated time, then asks for QUEUED_MESSAGE until the answer comes. If the device has no
///   queue, it repeats the request.
/// - ACK_OVERFLOW: collects the parts. After a lost part it asks for another parameter, which ends the responder's
///   session, and collects all parts again.
/// - No answer: two more tries. NACK: a fault that names the reason.
/// - Ignored: packets of other devices, to other controllers, with another transaction number or parameter.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/result.h"
#include "drivers/dmx/rdm/rdm_packet.h"

namespace luxrig::rdm {

struct Request {
  Uid to;
  CommandClass command_class = CommandClass::get;  ///< get or set
  Pid pid = Pid::device_info;
  std::vector<std::uint8_t> data{};
  std::uint16_t sub_device = 0;
};

struct TransactionTiming {
  Duration answer = std::chrono::milliseconds(300);  ///< a request counts as lost after this
  Duration whole = std::chrono::seconds(10);         ///< it is given up after this, whatever was answered so far
};

class Transaction {
 public:
  /// `number`: of this controller's last packet; incremented here. requires get or set, and data that fit.
  Transaction(Request request, const Uid& controller, std::uint8_t& number, TransactionTiming timing);

  /// The packet due at `now`, if any; it then counts as sent. Empty once there is a result.
  [[nodiscard]] std::optional<Packet> due(Time now);
  void hear(Time now, const Packet& packet);

  /// The data of the answer; empty for a broadcast. Faults:
  ///   timeout   no answer to three requests, or none in time
  ///   refused   NACK, with its reason and remedy
  ///   protocol  an answer that no device should give
  [[nodiscard]] const std::optional<Result<std::vector<std::uint8_t>>>& result() const { return result_; }

 private:
  /// The next request, or the one waiting for an answer.
  enum class Stage { question, queue, session_end };

  void accept(Time now, const Packet& packet);
  void take_ack(Time now, const Packet& packet);
  void next(Stage stage, Time at);
  void fail(Cause cause, std::string detail);
  [[nodiscard]] Packet packet_of(Stage stage) const;
  [[nodiscard]] bool answers(const Packet& packet) const;

  Request request_;
  Uid controller_;
  std::uint8_t& number_;
  TransactionTiming timing_;
  Stage stage_ = Stage::question;
  std::optional<Time> begun_, sent_;
  Time not_before_{};
  int lost_ = 0;  ///< unanswered requests in a row
  int queue_asked_ = 0;
  int restarts_ = 0;
  std::uint8_t sent_number_ = 0;
  std::vector<std::uint8_t> parts_;
  bool collecting_ = false;
  bool queue_last_ = false;  ///< ask the queue once more for its last message
  std::optional<Result<std::vector<std::uint8_t>>> result_;
};

}  // namespace luxrig::rdm
