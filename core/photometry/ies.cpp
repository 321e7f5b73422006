#include "core/photometry/ies.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

namespace luxrig {
namespace {

constexpr std::size_t kMaxAngles = 10'000;
constexpr std::size_t kMaxValues = 4'000'000;
constexpr std::uintmax_t kMaxFileBytes = 64u << 20;
constexpr std::size_t kMaxProblems = 20;  // of one file; a garbled one would give thousands
constexpr double kMaxCandela = 1e12;      // a lighthouse has 1e7
constexpr double kMinFlux_lm = 1e-6;      // below it nobody sees or dims anything
constexpr double kMinSpacing_deg = 1e-6;  // between neighbouring angles
constexpr double kMetresPerFoot = 0.3048;
constexpr double kFluxTolerance = 1.05;  // how far photometry may exceed its lamps' lumens

/// A place in the text that counts lines; \n, \r\n and lone \r end one.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end() const { return offset_ >= text_.size(); }
  [[nodiscard]] char peek() const { return text_[offset_]; }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] int column() const { return static_cast<int>(offset_ - line_start_) + 1; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - offset_; }

  void advance() {
    const char c = text_[offset_++];
    if (c == '\n' || (c == '\r' && (at_end() || text_[offset_] != '\n'))) {
      ++line_;
      line_start_ = offset_;
    }
  }

  /// The rest of this line without its end; the cursor moves to the next line.
  std::string_view take_line() {
    const std::size_t start = offset_;
    while (!at_end() && peek() != '\n' && peek() != '\r') advance();
    const std::string_view line = text_.substr(start, offset_ - start);
    if (!at_end() && peek() == '\r') {
      advance();
      if (!at_end() && peek() == '\n') advance();
    } else if (!at_end()) {
      advance();
    }
    return line;
  }

  /// The next run of characters between separators; empty at the end.
  std::string_view take_token() {
    while (!at_end() && is_separator(peek())) advance();
    const std::size_t start = offset_;
    while (!at_end() && !is_separator(peek())) advance();
    return text_.substr(start, offset_ - start);
  }

  void skip_separators() {
    while (!at_end() && is_separator(peek())) advance();
  }

 private:
  // Old files hold form feeds, NUL and ^Z; commas separate as blanks do.
  static bool is_separator(char c) { return static_cast<unsigned char>(c) <= ' ' || c == ','; }

  std::string_view text_;
  std::size_t offset_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

/// What a message may quote of a file: short, printable.
std::string excerpt(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > 40 ? "…'" : "'");
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& file_name) : cursor_(without_bom(text)), file_name_(file_name) {}

  Checked<IesFile> parse() {
    if (parse_all() && problems_.empty()) return std::move(file_);
    return tl::unexpected(std::move(problems_));
  }

 private:
  struct At {
    int line = 0;
    int column = 0;
  };

  static std::string_view without_bom(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    return text;
  }

  void problem(At at, std::string what, std::string mend) {
    if (problems_.size() < kMaxProblems) {
      problems_.push_back({file_name_, at.line, at.column, std::move(what), std::move(mend)});
    }
  }

  bool parse_all() {
    const auto tilt = parse_header();
    if (!tilt || !problems_.empty()) return false;
    return parse_tilt(*tilt) && parse_fields() && parse_angles() && parse_candela() && check_flux();
  }

  /// Up to "TILT="; the cursor then stands behind the '='. Returns where the line began.
  std::optional<At> parse_header() {
    bool first = true;
    while (!cursor_.at_end()) {
      const At at{cursor_.line(), cursor_.column()};
      Cursor line_start = cursor_;
      const std::string_view line = trimmed(cursor_.take_line());
      const std::string small = lower(line);
      if (small.rfind("tilt", 0) == 0) {
        const std::size_t equals = small.find_first_not_of(" \t", 4);
        if (equals != std::string::npos && small[equals] == '=') {
          cursor_ = line_start;
          while (cursor_.peek() != '=') cursor_.advance();
          cursor_.advance();
          return at;
        }
      }
      if (first && small.rfind("ies", 0) == 0) {
        file_.edition = std::string(line);
      } else if (!line.empty()) {
        // Far-UVC makers use this format with mW for lm; taken as candela it would light nothing anyone sees.
        if (small.find("w/sr") != std::string::npos || small.find("radiometric units") != std::string::npos) {
          problem(at, "radiometric data " + excerpt(line) + ", not candela",
                  "give the file of a visible-light luminaire, in candela");
          return std::nullopt;
        }
        file_.keywords.emplace_back(line);
      }
      first = false;
    }
    problem({}, "no TILT= line: not an IES LM-63 file", "give a photometric file whose header ends with TILT=NONE");
    return std::nullopt;
  }

  bool parse_tilt(At at) {
    const std::string value(cursor_.take_token());
    const std::string small = lower(value);
    if (small == "none") return true;
    if (small != "include") {
      problem(at, "TILT factors in another file, " + excerpt(value), "write them into this file with TILT=INCLUDE");
      return false;
    }
    const auto geometry = number("lamp-to-luminaire geometry", 1, 3);
    const auto count = whole("number of tilt angles", 1, kMaxAngles);
    if (!geometry || !count) return false;
    std::vector<double> angles, factors;
    if (!numbers("tilt angle", *count, 0, 180, angles) || !numbers("tilt factor", *count, 0, 10, factors)) return false;
    const auto upright = std::find(angles.begin(), angles.end(), 0.0);
    tilt_factor_ = upright == angles.end() ? factors.front() : factors[upright - angles.begin()];
    if (!(tilt_factor_ > 0)) {
      problem(at, "the tilt factor at 0° is 0", "give the factor of the lamp hung straight, usually 1");
      return false;
    }
    const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
    if (*least != *most)
      file_.warnings.push_back("lamp output depends on tilt; the factor for 0° is applied at any aim");
    return true;
  }

  bool parse_fields() {
    const auto lamps = whole("number of lamps", 1, 1'000'000);
    const auto lumens = number("lumens per lamp", -1, 1e12);
    const auto multiplier = number("candela multiplier", 0, 1e9);
    const auto vertical = whole("number of vertical angles", 1, kMaxAngles);
    const auto horizontal = whole("number of horizontal angles", 1, kMaxAngles);
    if (!horizontal) return false;
    cursor_.skip_separators();
    const At type_at{cursor_.line(), cursor_.column()};
    const auto type = whole("photometric type", 1, 3);
    const auto units = whole("units type", 1, 2);
    const auto width = number("luminous width", -1e6, 1e6);
    const auto length = number("luminous length", -1e6, 1e6);
    const auto height = number("luminous height", -1e6, 1e6);
    const auto ballast = number("ballast factor", 0, 1e6);
    const auto second = number("ballast-lamp photometric factor", 0, 1e6);
    const auto watts = number("input watts", 0, 1e9);
    if (!watts || !problems_.empty()) return false;  // `watts` is the last: without it the stream ended or broke
    if (*type != 1) {
      const std::string name = *type == 2 ? "B" : "A";
      problem(type_at, "type " + name + " photometry", "convert the file to type C");
      return false;
    }
    const At whole_file;
    if (*vertical < 2) problem(whole_file, "one vertical angle makes no distribution", "give two or more");
    if (*vertical * *horizontal > kMaxValues) {
      problem(whole_file,
              std::to_string(*vertical) + " x " + std::to_string(*horizontal) + " values, more than 4 million",
              "give a coarser grid");
    }
    if (*lumens < 0 && *lumens != -1) {
      problem(whole_file, "lumens per lamp is negative", "give lumens, or -1 for absolute photometry");
    }
    factor_ = *multiplier * *ballast * tilt_factor_;
    // LM-63-1986 and 1991 only: later it is 1 ("future use"), and since 2019 a code for how the file was made.
    const std::string edition = lower(file_.edition);
    const bool early = edition.empty() || (edition.size() >= 2 && (edition.substr(edition.size() - 2) == "91" ||
                                                                   edition.substr(edition.size() - 2) == "86"));
    if (early) factor_ *= *second;
    if (!(factor_ > 0)) problem(whole_file, "a multiplier or ballast factor is 0", "give the true factor, usually 1");
    const double metres = *units == 1 ? kMetresPerFoot : 1.0;
    file_.lamps = static_cast<int>(*lamps);
    file_.lumens_per_lamp = *lumens;
    file_.width_m = *width * metres;
    file_.length_m = *length * metres;
    file_.height_m = *height * metres;
    file_.input_w = *watts;
    verticals_ = *vertical;
    horizontals_ = *horizontal;
    return problems_.empty();
  }

  bool parse_angles() {
    cursor_.skip_separators();
    const At vertical_at{cursor_.line(), cursor_.column()};
    if (!numbers("vertical angle", verticals_, 0, 180, file_.vertical_deg)) return false;
    cursor_.skip_separators();
    const At horizontal_at{cursor_.line(), cursor_.column()};
    if (!numbers("horizontal angle", horizontals_, 0, 360, file_.horizontal_deg)) return false;
    check_ascending("vertical", file_.vertical_deg, vertical_at);
    check_ascending("horizontal", file_.horizontal_deg, horizontal_at);
    if (!problems_.empty()) return false;
    check_symmetry(horizontal_at);
    const double first = file_.vertical_deg.front();
    const double last = file_.vertical_deg.back();
    if ((first != 0 && first != 90) || (last != 90 && last != 180)) {
      file_.warnings.push_back("vertical angles " + text_of(first) + " to " + text_of(last) +
                               " degrees; no light is assumed outside");
    }
    return problems_.empty();
  }

  void check_ascending(const std::string& name, const std::vector<double>& angles, At at) {
    for (std::size_t i = 1; i < angles.size(); ++i) {
      if (angles[i] - angles[i - 1] < kMinSpacing_deg) {
        problem(at, name + " angles do not ascend: " + text_of(angles[i]) + " follows " + text_of(angles[i - 1]),
                "list each angle once, ascending");
        return;
      }
    }
  }

  void check_symmetry(At at) {
    const auto& angles = file_.horizontal_deg;
    if (angles.size() == 1) return;
    const double first = angles.front();
    const double last = angles.back();
    if (first == 0 && (last == 90 || last == 180 || last == 360)) return;
    if (first == 90 && last == 270) return;
    double widest = 0;
    for (std::size_t i = 1; i < angles.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
    // Planes that leave out 360: the gap to it is one spacing, as 0, 15 … 345.
    if (first == 0 && last > 180 && 360 - last <= 1.01 * widest) return;
    problem(at, "horizontal angles " + text_of(first) + " to " + text_of(last) + " fit no symmetry of type C",
            "start at 0 and end at 0, 90, 180 or 360; or 90 to 270");
  }

  bool parse_candela() {
    if (!numbers("candela value", verticals_ * horizontals_, 0, kMaxCandela, file_.candela)) return false;
    for (double& value : file_.candela) {
      value *= factor_;
      if (value > kMaxCandela) {
        problem({}, "candela values with their factors exceed 1e12", "correct the multiplier and ballast factor");
        return false;
      }
    }
    return true;
  }

  bool check_flux() {
    const double largest_cd = *std::max_element(file_.candela.begin(), file_.candela.end());
    const double flux_lm = 4 * kPi * largest_cd < kMinFlux_lm ? 0 : make_intensity(file_)->flux_lm();
    if (!(flux_lm >= kMinFlux_lm)) {
      problem({}, "the luminaire gives no light: " + text_of(flux_lm) + " lm", "give a file with candela values");
      return false;
    }
    const double lamps_lm = file_.lumens_per_lamp * file_.lamps;
    if (lamps_lm >= 0 && flux_lm > kFluxTolerance * lamps_lm) {
      file_.warnings.push_back("the distribution holds " + text_of(flux_lm) + " lm, its lamps only " +
                               text_of(lamps_lm) + " lm");
    }
    return true;
  }

  static std::string text_of(double value) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 6);
    return {buffer.data(), end.ptr};
  }

  std::optional<double> number(const std::string& what, double least, double most) {
    cursor_.skip_separators();
    const At at{cursor_.line(), cursor_.column()};
    std::string_view token = cursor_.take_token();
    if (token.empty()) {
      problem(at, "the file ends before the " + what, "give the whole file");
      return std::nullopt;
    }
    std::string_view digits = token;
    if (digits.front() == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      problem(at, what + " " + excerpt(token) + " is not a number", "write a plain number");
      broken_ = true;
      return std::nullopt;
    }
    if (value < least || value > most) {
      problem(at, what + " " + excerpt(token) + " is out of range",
              "give a value from " + text_of(least) + " to " + text_of(most));
    }
    return value;
  }

  std::optional<std::size_t> whole(const std::string& what, std::size_t least, std::size_t most) {
    cursor_.skip_separators();
    const At at{cursor_.line(), cursor_.column()};
    const std::size_t before = problems_.size();
    const auto value = number(what, static_cast<double>(least), static_cast<double>(most));
    if (!value) return std::nullopt;
    if (problems_.size() > before || problems_.size() >= kMaxProblems) return least;  // reported; go on
    if (*value != std::floor(*value)) {
      problem(at, what + " is not a whole number", "write a whole number");
      return least;
    }
    return static_cast<std::size_t>(*value);
  }

  /// `count` numbers into `out`; stops at the first that cannot be read.
  bool numbers(const std::string& what, std::size_t count, double least, double most, std::vector<double>& out) {
    out.reserve(std::min(count, cursor_.remaining() / 2 + 1));  // never more than the text can hold
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = number(what, least, most);
      if (!value) {
        if (!problems_.empty() && !broken_) {
          problems_.back().what += " " + std::to_string(i + 1) + " of " + std::to_string(count);
        }
        return false;
      }
      if (problems_.size() >= kMaxProblems) return false;
      out.push_back(*value);
    }
    return problems_.empty();
  }

  Cursor cursor_;
  const std::string& file_name_;
  IesFile file_;
  std::vector<Problem> problems_;
  bool broken_ = false;  // a token that is no number: what follows has lost its meaning
  double tilt_factor_ = 1;
  double factor_ = 1;
  std::size_t verticals_ = 0;
  std::size_t horizontals_ = 0;
};

}  // namespace

Checked<IesFile> parse_ies(std::string_view text, const std::string& file_name) {
  return Parser(text, file_name).parse();
}

Checked<IesFile> load_ies(const std::filesystem::path& path) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{path.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {  // a pipe would block
    return refuse("no such photometric file", "correct its name, relative to the rig file");
  }
  const auto bytes = std::filesystem::file_size(path, error);
  if (error || bytes > kMaxFileBytes) return refuse("larger than 64 MiB", "give an IES LM-63 file");
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in.good() && !in.eof()) return refuse("cannot be read", "check that you may read it");
  return parse_ies(text, path.string());
}

}  // namespace luxrig
