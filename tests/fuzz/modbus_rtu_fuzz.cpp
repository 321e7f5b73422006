/// Any bytes on a serial line, heard by both ends: our search for an answer, and the simulated units. Input: which
/// request, then the bytes. A found answer must be in the bytes with a correct checksum; a correct answer appended to
/// the bytes must be found unless they already hold one; units never answer more than was requested.
#include <algorithm>
#include <cstdint>

#include "core/check.h"
#include "drivers/modbus/modbus_rtu_frame.h"
#include "sim/wire/modbus/modbus_rtu_session.h"
#include "tests/fuzz/modbus_requests.h"

namespace {

using namespace luxrig::modbus;
using Bytes = std::vector<std::uint8_t>;

class AnyUnits final : public luxrig::sim::ModbusUnits {
 public:
  [[nodiscard]] bool has(int) const override { return true; }
  [[nodiscard]] bool has_bits(int) const override { return true; }
  std::optional<luxrig::sim::ModbusException> write_coils(int, int first,
                                                          std::span<const std::uint16_t> bits) override {
    LUXRIG_CHECK(first >= 0 && static_cast<std::size_t>(first) + bits.size() <= 65536, "{}", first);
    for (const std::uint16_t bit : bits) LUXRIG_CHECK(bit <= 1, "{}", bit);
    return std::nullopt;
  }
  std::optional<luxrig::sim::ModbusException> read(int, luxrig::sim::RegisterKind, int first,
                                                   std::span<std::uint16_t> values) override {
    LUXRIG_CHECK(first >= 0 && static_cast<std::size_t>(first) + values.size() <= 65536, "{}", first);
    return std::nullopt;
  }
  std::optional<luxrig::sim::ModbusException> write(int, int first, std::span<const std::uint16_t> values) override {
    LUXRIG_CHECK(first >= 0 && static_cast<std::size_t>(first) + values.size() <= 65536, "{}", first);
    return std::nullopt;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > 4096) return 0;
  const Request request = luxrig::fuzz::request_for(data[0]);
  const Bytes heard(data + 1, data + size);
  const RtuSearch search = find_rtu_answer(request, heard);
  if (search.answer) {
    LUXRIG_CHECK(search.answer->verdict != Verdict::foreign, "answers have no number");
    if (search.answer->verdict == Verdict::good && reads(request.function)) {
      LUXRIG_CHECK(search.answer->values.size() == request.count, "{}", search.answer->values.size());
    }
  } else {
    LUXRIG_CHECK(!search.what.empty(), "no word about {} bytes", heard.size());
    const Bytes asked = encode_rtu(request);
    Bytes right = asked;  // the answer to a single write is its echo
    if (reads(request.function)) {
      right = {asked[0], asked[1], static_cast<std::uint8_t>(data_bytes(request))};
      right.resize(3 + data_bytes(request), 0x5A);
    } else if (request.function == Function::write_multiple) {
      right.resize(6);
    } else {
      right.resize(6);
    }
    const std::uint16_t sum = rtu_checksum(right);
    right.push_back(static_cast<std::uint8_t>(sum));
    right.push_back(static_cast<std::uint8_t>(sum >> 8));
    LUXRIG_CHECK(right.size() == rtu_answer_size(request), "{}", right.size());
    Bytes both = heard;
    both.insert(both.end(), right.begin(), right.end());
    LUXRIG_CHECK(find_rtu_answer(request, both).answer, "an answer behind {} bytes was missed", heard.size());
  }

  AnyUnits units;
  luxrig::sim::ModbusRtuSession session;
  std::size_t answers = 0;
  luxrig::Time now{};
  for (std::size_t at = 0; at < heard.size();) {
    const std::size_t piece = std::min<std::size_t>(1 + heard[at] % 32, heard.size() - at);
    for (const auto& answer : session.receive(now, std::span(heard).subspan(at, piece), units)) {
      LUXRIG_CHECK(answer.bytes.size() <= kLongestRtuFrame && luxrig::sim::line_checksum(answer.bytes) == 0, "{} bytes",
                   answer.bytes.size());
      ++answers;
    }
    at += piece;
    now += std::chrono::milliseconds(heard[at - 1] % 64);
  }
  LUXRIG_CHECK(4 * answers <= heard.size(), "{} answers to {} bytes", answers, heard.size());
  return 0;
}
