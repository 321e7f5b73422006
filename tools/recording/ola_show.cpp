// A show by OLA's ola_recorder -> Recording. Source: the man page of ola_recorder, and files that it wrote.
//
//   OLA Show
//   1 255,0,17        universe, then slots from address 1; an empty one is 0
//   25                milliseconds until the next line
//   1 255,0,18
#include <fmt/format.h>

#include <charconv>

#include "core/text/plain_text.h"
#include "drivers/dmx/dmx_patch.h"
#include "tools/recording/recording.h"

namespace luxrig::recording {
namespace {

constexpr std::string_view kHeader = "OLA Show";
/// A desk repeats what does not change; this file may not have it. sACN asks for a packet every second at least.
constexpr Duration kRepeat = std::chrono::milliseconds(800);
constexpr std::size_t kMaxRepeats = 200'000, kMaxUniverses = 64;

/// The whole text as a number of 0…greatest; empty if it is none.
std::optional<std::int64_t> whole_number(std::string_view text, std::int64_t greatest) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > greatest) return std::nullopt;
  return value;
}

class OlaReader {
 public:
  explicit OlaReader(std::string file) : file_(std::move(file)) {}

  Checked<Recording> read(std::string_view text) {
    recording_.sources.push_back({Protocol::ola, "ola_recorder", {}, {}, false, {}, 0});
    bool frame = true;
    for (; !text.empty(); ++line_) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line_ == 1) {
        if (line != kHeader)
          return problem(fmt::format("the format {} is not known", in_quotes(line)), "record it with ola_recorder");
        continue;
      }
      if (line.empty()) break;  // as ola_recorder reads it
      if (auto wrong = frame ? take_frame(line) : take_delay(line)) return std::move(*wrong);
      frame = !frame;
    }
    if (recording_.dmx.empty()) return problem("there is no frame in it", "record while a desk sends");
    recording_.length = at_;
    return std::move(recording_);
  }

 private:
  using Wrong = std::optional<tl::unexpected<std::vector<Problem>>>;

  [[nodiscard]] tl::unexpected<std::vector<Problem>> problem(std::string what, std::string mend) const {
    return tl::unexpected(std::vector<Problem>{{file_, line_, 1, std::move(what), std::move(mend)}});
  }

  Wrong take_frame(std::string_view line) {
    const std::size_t blank = line.find(' ');
    const auto universe =
        blank == line.npos ? std::nullopt : whole_number(line.substr(0, blank), sacn::kHighestUniverse);
    if (!universe)
      return problem(fmt::format("{} does not begin with a universe", in_quotes(line)),
                     "write `1 255,0,17`: universe, blank, slots");
    std::string_view rest = line.substr(blank + 1);
    std::vector<std::uint8_t> slots;
    for (bool more = true; more;) {
      const std::size_t comma = rest.find(',');
      more = comma != rest.npos;
      const std::string_view word = rest.substr(0, comma);
      rest.remove_prefix(more ? comma + 1 : rest.size());
      const auto value = word.empty() ? std::optional<std::int64_t>(0) : whole_number(word, 255);
      if (!value) return problem(fmt::format("{} is no value of a slot", in_quotes(word)), "write 0 to 255");
      if (slots.size() == kDmxSlots)
        return problem("it has more than 512 slots", "give each universe at most 512 values");
      slots.push_back(static_cast<std::uint8_t>(*value));
    }
    last_[static_cast<int>(*universe)] = {at_, slots};
    if (last_.size() > kMaxUniverses)
      return problem(fmt::format("it has more than {} universes", kMaxUniverses), "record fewer");
    add(at_, static_cast<int>(*universe), std::move(slots));
    return std::nullopt;
  }

  Wrong take_delay(std::string_view line) {
    const auto delay_ms = whole_number(line, std::chrono::duration_cast<std::chrono::milliseconds>(kLongest).count());
    if (!delay_ms)
      return problem(fmt::format("{} is no number of milliseconds", in_quotes(line)),
                     "write how long it is until the next line, at most a week");
    const Duration next = at_ + std::chrono::milliseconds(*delay_ms);
    if (next > kLongest) return problem("by here it is longer than a week", "record a shorter time");
    // In order of time: the universe that is due first.
    for (;;) {
      auto due = last_.begin();
      for (auto one = last_.begin(); one != last_.end(); ++one)
        if (one->second.at < due->second.at) due = one;
      if (due == last_.end() || due->second.at + kRepeat >= next) break;
      if (++repeats_ > kMaxRepeats) return problem("by here too much is to be repeated", "record a shorter time");
      due->second.at += kRepeat;
      add(due->second.at, due->first, due->second.slots);
    }
    at_ = next;
    return std::nullopt;
  }

  void add(Duration at, int universe, std::vector<std::uint8_t> slots) {
    recording_.sources.front().universes.insert(universe);
    ++recording_.sources.front().packets;
    ++recording_.packets;
    recording_.dmx.push_back({at, 0, universe, std::move(slots)});
  }

  std::string file_;
  int line_ = 1;
  Duration at_{};
  struct Last {
    Duration at{};
    std::vector<std::uint8_t> slots;
  };
  std::map<int, Last> last_;  ///< by universe
  std::size_t repeats_ = 0;
  Recording recording_;
};

}  // namespace

Checked<Recording> read_ola_show(std::string_view text, const std::string& file) { return OlaReader(file).read(text); }

}  // namespace luxrig::recording
