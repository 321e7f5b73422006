#include "drivers/dmx/rdm/rdm_client.h"

#include "core/check.h"

namespace luxrig::rdm {
namespace {

constexpr int kPacketsPerStep = 64;

}  // namespace

void Client::begin(Request request, Duration whole) {
  LUXRIG_CHECK(idle(), "a question is under way");
  link_fault_.reset();
  transaction_.emplace(std::move(request), controller_, number_, TransactionTiming{link_.answer_within(), whole});
}

void Client::step(Time now) {
  for (int i = 0; i < kPacketsPerStep; ++i) {
    const auto bytes = link_.receive(now);
    if (!bytes) break;
    if (!transaction_) continue;
    if (const auto packet = decode(*bytes)) transaction_->hear(now, *packet);
  }
  if (!transaction_ || link_fault_) return;
  if (const auto packet = transaction_->due(now)) {
    if (auto sent = link_.send(now, encode(*packet)); !sent) link_fault_ = sent.error();
  }
}

std::optional<Result<std::vector<std::uint8_t>>> Client::take() {
  std::optional<Result<std::vector<std::uint8_t>>> taken;
  if (!transaction_) return taken;
  if (link_fault_) {
    taken.emplace(tl::unexpected(*link_fault_));
  } else if (transaction_->result()) {
    taken = transaction_->result();
  }
  if (taken) transaction_.reset();
  return taken;
}

}  // namespace luxrig::rdm
