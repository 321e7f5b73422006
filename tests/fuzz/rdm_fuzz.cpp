/// RDM decoders. The first byte selects the rest: a packet, an answer to a branch, parameter data, or packets to a
/// transaction, each with the delay since the last.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "drivers/dmx/rdm/rdm_discovery.h"
#include "drivers/dmx/rdm/rdm_transaction.h"
#include "drivers/dmx/rdm/rdm_values.h"

namespace {

using namespace luxrig;
using namespace luxrig::rdm;

void read_packet(std::span<const std::uint8_t> bytes) {
  const auto packet = decode(bytes);
  if (!packet) return;
  const auto again = encode(*packet);
  if (again.size() > bytes.size() || !std::equal(again.begin(), again.end(), bytes.begin())) std::abort();
}

void read_branch_answer(std::span<const std::uint8_t> bytes) {
  const auto uid = decode_branch_answer(bytes);
  if (uid && decode_branch_answer(encode_branch_answer(*uid)) != uid) std::abort();
}

void read_values(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2) return;
  const auto data = bytes.subspan(2);
  for (const char letter : describe(static_cast<Pid>(bytes[0] << 8 | bytes[1]), data)) {
    if (static_cast<std::uint8_t>(letter) < 0x20) std::abort();
  }
  if (const auto info = decode_device_info(data)) {
    if (info->footprint_slots < 0 || info->footprint_slots > 512) std::abort();
    if (info->start_address && (*info->start_address < 1 || *info->start_address > 512)) std::abort();
  }
  if (const auto slots = decode_slot_info(data)) {
    for (const SlotInfo& slot : *slots) {
      if (slot.offset < 0 || slot.offset >= 512) std::abort();
    }
  }
  if (const auto sensor = decode_sensor_definition(data)) (void)text_of(*sensor, sensor->range_max);
}

// Each packet: delay in units of 50 ms, response type, parameter (two bytes), messages, length, data. It comes from the
// device under question, so that it is accepted.
void talk(std::span<const std::uint8_t> bytes) {
  std::uint8_t number = 0;
  const Uid self{0x7ff0, 1}, device{0x7a70, 2};
  Transaction transaction({device, CommandClass::get, Pid::lamp_hours}, self, number, {});
  Time now{};
  Packet last;
  int sent = 0;
  const auto step = [&] {
    if (const auto packet = transaction.due(now)) {
      if (transaction.result()) std::abort();
      last = *packet;
      ++sent;
    }
  };
  step();
  while (bytes.size() >= 6) {
    now += std::chrono::milliseconds(50 * bytes[0]);
    Packet answer = last;
    std::swap(answer.to, answer.from);
    answer.command_class = response_to(last.command_class);
    answer.port_or_type = bytes[1];
    answer.pid = static_cast<Pid>(bytes[2] << 8 | bytes[3]);
    answer.message_count = bytes[4];
    const std::size_t length = std::min<std::size_t>(bytes[5], bytes.size() - 6);
    answer.data.assign(bytes.begin() + 6, bytes.begin() + 6 + static_cast<std::ptrdiff_t>(length));
    bytes = bytes.subspan(6 + length);
    transaction.hear(now, answer);
    step();
  }
  // Without answers it ends, within its bound and after a few more questions.
  const int before = sent;
  for (int i = 0; i < 250; ++i) {
    now += std::chrono::milliseconds(50);
    step();
  }
  if (!transaction.result() || sent - before > 12) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      read_packet(rest);
      break;
    case 1:
      read_branch_answer(rest);
      break;
    case 2:
      read_values(rest);
      break;
    default:
      talk(rest);
      break;
  }
  return 0;
}
