#pragma once
/// Requests to the devices of one DMX line, one at a time, over any link. Never blocks: begin(), then step() every few
/// milliseconds until take() has a result.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/dmx/rdm/rdm_transaction.h"

namespace luxrig::rdm {

/// Carries RDM packets to one DMX line and back: a gateway on the network, a USB interface. Never blocks.
class RdmLink {
 public:
  virtual ~RdmLink() = default;
  /// A packet from start code to checksum.
  virtual Result<void> send(Time now, std::span<const std::uint8_t> packet) = 0;
  /// The next packet received from the line, from start code to checksum, if any.
  virtual std::optional<std::vector<std::uint8_t>> receive(Time now) = 0;
  /// A request without an answer for this long counts as lost.
  [[nodiscard]] virtual Duration answer_within() const = 0;
};

class Client {
 public:
  /// `controller`: UID of the requester. The link outlives the client.
  Client(RdmLink& link, const Uid& controller) : link_(link), controller_(controller) {}
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// requires idle(). It is answered or given up within `whole`.
  void begin(Request request, Duration whole = TransactionTiming{}.whole);
  [[nodiscard]] bool idle() const { return !transaction_; }
  void step(Time now);
  /// The answer, once; faults as in Transaction::result, and `network` if the link cannot send.
  [[nodiscard]] std::optional<Result<std::vector<std::uint8_t>>> take();

 private:
  RdmLink& link_;
  Uid controller_;
  std::uint8_t number_ = 0;
  std::optional<Transaction> transaction_;
  std::optional<Fault> link_fault_;
};

}  // namespace luxrig::rdm
