#pragma once
/// One question to one device until it is answered: `now` and packets in, packets out. Never waits by itself.
/// Source: ANSI E1.20-2010, chapter 6.
///
/// - ACK_TIMER: waits as long as it says, then asks for QUEUED_MESSAGE until the answer comes, or asks again when the
///   device has no queue.
/// - ACK_OVERFLOW: collects the parts. A part that is lost breaks the whole off: another parameter is asked for, which
///   ends the responder's session, and all is collected anew.
/// - No answer: twice more. NACK: a fault that names the reason.
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
  Duration answer = std::chrono::milliseconds(300);  ///< a question counts as lost after
  Duration whole = std::chrono::seconds(10);         ///< it is given up after, whatever was answered in between
};

class Transaction {
 public:
  /// `number`: of the last packet this controller sent; counted on. requires get or set, and data that fit.
  Transaction(Request request, const Uid& controller, std::uint8_t& number, TransactionTiming timing);

  /// The packet to send at `now`, if one is due; it then counts as sent. Nothing once there is a result.
  [[nodiscard]] std::optional<Packet> due(Time now);
  void hear(Time now, const Packet& packet);

  /// The data of the answer; a broadcast's are empty. Faults:
  ///   timeout   no answer to three questions, or none in time
  ///   refused   NACK, with its reason and what would mend it
  ///   protocol  an answer that no device should give
  [[nodiscard]] const std::optional<Result<std::vector<std::uint8_t>>>& result() const { return result_; }

 private:
  /// What is asked next, or waited for.
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
  int lost_ = 0;  ///< questions in a row that were not answered
  int queue_asked_ = 0;
  int restarts_ = 0;
  std::uint8_t sent_number_ = 0;
  std::vector<std::uint8_t> parts_;
  bool collecting_ = false;
  bool queue_last_ = false;  ///< the queue is asked for its last message once more
  std::optional<Result<std::vector<std::uint8_t>>> result_;
};

}  // namespace luxrig::rdm
