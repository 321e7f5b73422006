#include "core/rig/personality/gdtf/gdtf_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rig/personality/gdtf/gdtf_modes.h"
#include "core/rig/personality/zip_archive.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxModes = 256;

DmxProfile profile_of(const pugi::xml_node& node) {
  DmxProfile profile;
  profile.name = plain_attribute(node, "Name");
  for (const pugi::xml_node& point : node.children("Point")) {
    DmxProfile::Piece piece;
    piece.from = std::clamp(number_attribute(point, "DMXPercentage", 0), 0.0, 1.0);
    const char* const names[] = {"CFC0", "CFC1", "CFC2", "CFC3"};
    for (int i = 0; i < 4; ++i) piece.c[i] = number_attribute(point, names[i], 0);
    profile.pieces.push_back(piece);
  }
  std::stable_sort(profile.pieces.begin(), profile.pieces.end(),
                   [](const DmxProfile::Piece& a, const DmxProfile::Piece& b) { return a.from < b.from; });
  return profile;
}

}  // namespace

Checked<Personality> parse_gdtf_description(std::string_view text, const std::string& file) {
  const Checked<XmlFile> xml = XmlFile::parse(text, file);
  if (!xml) return tl::unexpected(xml.error());
  ProblemList problems(file);
  Personality out;
  const pugi::xml_node root = xml->root(), type = root.child("FixtureType");
  if (std::string_view(root.name()) != "GDTF" || !type) {
    problems.add(xml->place_of(root), "not the description of a GDTF file: no <GDTF> with a <FixtureType>",
                 "name a .gdtf file, or an Open Fixture Library file that ends in .json");
    return tl::unexpected(problems.take());
  }
  const double version = number_attribute(root, "DataVersion", 1.0);
  if (version >= 2) {
    problems.add(xml->place_of(root), fmt::format("DataVersion {:g} is not known", version),
                 "export the fixture as GDTF 1.2");
    return tl::unexpected(problems.take());
  }
  out.manufacturer = plain_attribute(type, "Manufacturer");
  out.name = plain_attribute(type, "Name");
  for (const pugi::xml_node& node : type.child("PhysicalDescriptions").child("DMXProfiles").children("DMXProfile"))
    out.profiles.push_back(profile_of(node));
  std::size_t room = kMaxGdtfParts;
  for (const pugi::xml_node& node : type.child("DMXModes").children("DMXMode")) {
    if (out.modes.size() == kMaxModes) {
      problems.add(xml->place_of(node), fmt::format("more than {} modes", kMaxModes), "do not trust the file");
      break;
    }
    if (problems.full()) break;
    out.modes.push_back(read_gdtf_mode(*xml, type, node, out, room, problems));
  }
  if (out.modes.empty() && problems.empty())
    problems.add(xml->place_of(type), "the fixture has no DMX mode", "add one in the fixture builder");
  if (!problems.empty()) return tl::unexpected(problems.take());
  return out;
}

Checked<Personality> read_gdtf(std::string bytes, const std::string& file) {
  const Checked<ZipArchive> archive = ZipArchive::open(std::move(bytes), file);
  if (!archive) return tl::unexpected(archive.error());
  const std::string* description = archive->find("description.xml");
  if (description == nullptr) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, "no description.xml in the archive", "a GDTF file has one at its root; get the file again"}});
  }
  const Checked<std::string> xml = archive->read(*description, kMaxXmlBytes);
  if (!xml) return tl::unexpected(xml.error());
  return parse_gdtf_description(*xml, file + "/" + *description);
}

}  // namespace luxrig
