#include "core/photometry/files/photometric_file.h"

#include <utility>

#include "core/photometry/files/eulumdat.h"
#include "core/photometry/files/file_text.h"
#include "core/photometry/files/ies.h"

namespace luxrig {
namespace {

using namespace file_text;

bool has_tilt_line(std::string_view text) {
  for (Cursor cursor(text); !cursor.at_end();) {
    const std::string line = lower(trimmed(cursor.take_line()));
    if (line.rfind("tilt", 0) != 0) continue;
    const std::size_t equals = line.find_first_not_of(" \t", 4);
    if (equals != std::string::npos && line[equals] == '=') return true;
  }
  return false;
}

/// Whether lines 2 to 7 hold one number each. The two distances may be empty.
bool has_numbers_of_eulumdat(std::string_view text) {
  Cursor cursor(text);
  cursor.take_line();
  for (int field = 2; field <= 7; ++field) {
    if (cursor.at_end()) return false;
    std::string line(trimmed(cursor.take_line()));
    for (char& c : line) c = c == ',' ? '.' : c;
    const bool may_be_empty = field == 5 || field == 7;
    if (line.empty() ? !may_be_empty : !number_of(line)) return false;
  }
  return true;
}

}  // namespace

Checked<PhotometricFile> parse_photometric_text(std::string_view text, const std::string& file_name,
                                                const TiltFiles& tilt_files) {
  const std::optional<std::string> decoded = from_utf16(text);
  const std::string_view plain = without_bom(decoded ? std::string_view(*decoded) : text);
  const std::string name = lower(file_name);
  const bool named_eulumdat = name.ends_with(".ldt");
  const bool ies = has_tilt_line(plain);
  const bool eulumdat = !ies && (has_numbers_of_eulumdat(plain) || named_eulumdat);
  PhotometricFile out;
  if (eulumdat) {
    Checked<EulumdatFile> file = parse_eulumdat(plain, file_name);
    if (!file) return tl::unexpected(std::move(file.error()));
    out = {make_intensity(*file), luminous_opening(*file), std::nullopt, file->lamp_sets.front().watts,
           std::move(file->warnings)};
  } else {
    Checked<IesFile> file = parse_ies(plain, file_name, tilt_files);
    if (!file) return tl::unexpected(std::move(file.error()));
    out = {make_intensity(*file), luminous_opening(*file), std::move(file->tilt), file->input_w,
           std::move(file->warnings)};
  }
  if (ies && named_eulumdat) out.warnings.push_back("named .ldt, but its content is IES LM-63: read as that");
  if (eulumdat && name.ends_with(".ies")) {
    out.warnings.push_back("named .ies, but its content is EULUMDAT: read as that");
  }
  return out;
}

}  // namespace luxrig
