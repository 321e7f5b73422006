#include "core/rig/luminaire_file/gldf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/photometry/files/file_text.h"
#include "core/rig/luminaire_file/choices.h"
#include "core/rig/luminaire_file/tm33_file.h"
#include "core/rig/luminaire_file/xml_child.h"
#include "core/rig/personality/zip_archive.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxPhotometryBytes = std::size_t{64} << 20;
constexpr double kMaxRated_lm = 1e8;

using Names = std::vector<std::string>;

/// The text of the first <Locale> of <Name>, whichever language that is.
std::string first_name(const pugi::xml_node& node) { return text_of_child(child_called(node, "Name"), "Locale"); }

class GldfProduct {
 public:
  GldfProduct(const XmlFile& xml, const LuminairePart& part)
      : xml_(xml), part_(part), definitions_(child_called(xml.root(), "GeneralDefinitions")) {}

  Checked<GldfLight> light() {
    const pugi::xml_node emitter = emitter_of(variant_emitters());
    if (emitter) read_emitter(emitter);
    if (!problems_.empty()) return tl::unexpected(problems_);
    return light_;
  }

 private:
  void refuse(const pugi::xml_node& node, std::string what, std::string mend) {
    const FilePosition in_file = xml_.place_of(node ? node : xml_.root());
    problems_.push_back({xml_.file(), in_file.line, in_file.column, std::move(what), std::move(mend)});
  }

  /// The element with that id in a list of <GeneralDefinitions>; a problem if it is missing.
  pugi::xml_node defined(std::string_view list, std::string_view id, const pugi::xml_node& wanted_by) {
    for (const pugi::xml_node& node : child_called(definitions_, list).children())
      if (node.type() == pugi::node_element && id == node.attribute("id").value()) return node;
    refuse(wanted_by, fmt::format("{} has nothing with the id {}", list, in_quotes(id)),
           "export the file again from the program that made it");
    return {};
  }

  /// Ids of the emitters that an element refers to, in order, each once.
  static Names emitters_in(const pugi::xml_node& node) {
    Names ids;
    struct Walker : pugi::xml_tree_walker {
      Names* ids = nullptr;
      bool for_each(pugi::xml_node& at) override {
        const std::string id = at.attribute("emitterId").value();
        if (!id.empty() && std::find(ids->begin(), ids->end(), id) == ids->end()) ids->push_back(id);
        return true;
      }
    } walker;
    walker.ids = &ids;
    pugi::xml_node root = node;
    root.traverse(walker);
    return ids;
  }

  /// Emitters of the chosen variant; empty with a problem.
  Names variant_emitters() {
    const pugi::xml_node list = child_called(child_called(xml_.root(), "ProductDefinitions"), "Variants");
    std::vector<Choice> choices;
    std::vector<Names> emitters;
    for (const pugi::xml_node& node : children_called(list, "Variant")) {
      choices.push_back({plain_attribute(node, "id"), first_name(node)});
      emitters.push_back(emitters_in(node));
    }
    if (choices.empty()) {
      refuse(list, "the product has no variant", "export the file again from the program that made it");
      return {};
    }
    const bool all_alike =
        std::all_of(emitters.begin(), emitters.end(), [&](const Names& one) { return one == emitters.front(); });
    std::size_t chosen = 0;
    if (part_.variant || !all_alike) {
      const auto index = choose(choices, part_.variant, "variant", "file_variant");
      if (!index) {
        refuse(list, index.error().what, index.error().mend);
        return {};
      }
      chosen = *index;
    }
    if (emitters[chosen].empty())
      refuse(list, fmt::format("variant {} has no emitter", in_quotes(choices[chosen].name)), "choose another variant");
    return emitters[chosen];
  }

  pugi::xml_node emitter_of(const Names& ids) {
    std::vector<Choice> choices;
    std::vector<pugi::xml_node> nodes;
    for (const std::string& id : ids) {
      const pugi::xml_node node = defined("Emitters", id, child_called(xml_.root(), "ProductDefinitions"));
      if (!node) return {};
      if (child_called(node, "Sensor")) continue;  // listed as emitters, but give no light
      choices.push_back({made_plain(id), first_name(normal_option(node))});
      nodes.push_back(node);
    }
    if (!problems_.empty()) return {};
    if (choices.empty()) {
      refuse(child_called(xml_.root(), "ProductDefinitions"), "the variant has no emitter that gives light",
             "choose another variant");
      return {};
    }
    const auto index = choose(choices, part_.emitter, "emitter", "file_emitter");
    if (index) return nodes[*index];
    refuse(child_called(definitions_, "Emitters"), index.error().what,
           index.error().mend + (part_.emitter ? "" : ", and hang one fixture for each that shines"));
    return {};
  }

  /// The light of an emitter in normal operation (not emergency lighting).
  static pugi::xml_node normal_option(const pugi::xml_node& emitter) {
    for (const pugi::xml_node& option : emitter.children()) {
      const bool light = local_name(option) == "FixedLightEmitter" || local_name(option) == "ChangeableLightEmitter" ||
                         local_name(option) == "MultiChannelLightEmitter";
      if (light && std::string_view(option.attribute("emergencyBehaviour").value()) != "EmergencyOnly") return option;
    }
    return {};
  }

  void read_emitter(const pugi::xml_node& emitter) {
    const pugi::xml_node option = normal_option(emitter);
    const std::string name = in_quotes(emitter.attribute("id").value());
    if (!option)
      return refuse(emitter, fmt::format("emitter {} gives no light but in an emergency", name), "choose another");
    if (local_name(option) == "MultiChannelLightEmitter") {
      return refuse(option, fmt::format("emitter {} mixes several channels of light", name),
                    "unpack the photometric file of each channel, and give it to a luminaire of its own");
    }
    const pugi::xml_node reference = child_called(option, "PhotometryReference");
    if (!reference) {
      return refuse(option, fmt::format("emitter {} has no photometry", name),
                    "ask the maker for its photometric file");
    }
    const pugi::xml_node photometry = defined("Photometries", reference.attribute("photometryId").value(), reference);
    if (!photometry) return;
    const pugi::xml_node of_file = child_called(photometry, "PhotometryFileReference");
    if (!of_file) {
      return refuse(photometry, fmt::format("photometry of emitter {} has no file", name),
                    "ask the maker for its photometric file");
    }
    const pugi::xml_node file = defined("Files", of_file.attribute("fileId").value(), of_file);
    if (!file) return;
    light_.photometry_file = std::string(without_blanks(file.child_value()));
    if (std::string_view(file.attribute("type").value()) == "url") {
      return refuse(file,
                    fmt::format("its photometry is not in the file, but at {}", in_quotes(light_.photometry_file)),
                    "download it, and name that file here");
    }
    read_flux(option);
    const pugi::xml_node rotation = child_called(option, "Rotation");
    for (const pugi::xml_node& angle : rotation.children()) {
      if (finite_number(angle.child_value()).value_or(0) == 0) continue;
      light_.warnings.push_back(
          "its emitter is turned inside the luminaire: the light is taken as its photometric file has it");
      break;
    }
  }

  void read_flux(const pugi::xml_node& option) {
    if (local_name(option) == "ChangeableLightEmitter") {
      light_.warnings.push_back("its lamps can be changed: the flux of its photometric file is taken");
      return;
    }
    if (const pugi::xml_node flux = child_called(option, "RatedLuminousFlux")) {
      const std::optional<double> lm = finite_number(flux.child_value());
      if (!lm || !(*lm > 0) || *lm > kMaxRated_lm) {
        return refuse(flux, fmt::format("RatedLuminousFlux {} is no flux", in_quotes(flux.child_value())),
                      "write lumens, above 0");
      }
      light_.rated_lm = *lm;
    }
    const pugi::xml_node source = child_called(option, "LightSourceReference");
    const std::string_view id = source.attribute("fixedLightSourceId").value();
    for (const pugi::xml_node& node : child_called(definitions_, "LightSources").children()) {
      if (id.empty() || id != node.attribute("id").value()) continue;
      const auto input_w = finite_number(text_of_child(node, "RatedInputPower"));
      if (input_w && *input_w >= 0) light_.input_w = *input_w;
    }
  }

  const XmlFile& xml_;
  const LuminairePart& part_;
  pugi::xml_node definitions_;
  std::vector<Problem> problems_;
  GldfLight light_;
};

/// The archive entry that product.xml means: in ldc/ if it is there, else in any folder.
const std::string* entry_called(const ZipArchive& archive, const std::string& name) {
  const std::string wanted = file_text::lower(name);
  const std::string* found = nullptr;
  for (const std::string& entry : archive.names()) {
    const std::string small = file_text::lower(entry);
    if (small == "ldc/" + wanted) return &entry;
    if (!found && (small == wanted || small.ends_with("/" + wanted))) found = &entry;
  }
  return found;
}

}  // namespace

Checked<GldfLight> parse_gldf_product(std::string_view text, const std::string& file, const LuminairePart& part) {
  const std::optional<std::string> decoded = file_text::from_utf16(text);
  const Checked<XmlFile> xml = XmlFile::parse(decoded ? std::string_view(*decoded) : text, file);
  if (!xml) return tl::unexpected(xml.error());
  if (local_name(xml->root()) != "Root" || !child_called(xml->root(), "GeneralDefinitions")) {
    const FilePosition in_file = xml->place_of(xml->root());
    return tl::unexpected(std::vector<Problem>{{file, in_file.line, in_file.column,
                                                "not the product of a GLDF file: no <Root> with <GeneralDefinitions>",
                                                "get the file again from where it came"}});
  }
  return GldfProduct(*xml, part).light();
}

Checked<PhotometricFile> read_gldf(std::string bytes, const std::string& file, const LuminairePart& part) {
  const Checked<ZipArchive> archive = ZipArchive::open(std::move(bytes), file);
  if (!archive) return tl::unexpected(archive.error());
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, std::move(what), std::move(mend)}});
  };
  const std::string* product = archive->find("product.xml");
  if (product == nullptr) {
    const bool gdtf = archive->find("description.xml") != nullptr;
    return refuse("no product.xml in the archive",
                  gdtf ? "this is a GDTF file: name it in a fixture's personality" : "a GLDF file has one at its root");
  }
  const Checked<std::string> xml = archive->read(*product, kMaxXmlBytes);
  if (!xml) return tl::unexpected(xml.error());
  Checked<GldfLight> light = parse_gldf_product(*xml, file + "/" + *product, part);
  if (!light) return tl::unexpected(std::move(light.error()));
  const std::string* entry = entry_called(*archive, light->photometry_file);
  if (entry == nullptr) {
    return refuse(fmt::format("{} is not in the archive", in_quotes("ldc/" + light->photometry_file)),
                  "export the file again with its photometry");
  }
  const Checked<std::string> text = archive->read(*entry, kMaxPhotometryBytes);
  if (!text) return tl::unexpected(text.error());
  const std::string inner = file + "/" + made_plain(*entry);
  Checked<PhotometricFile> out =
      is_xml(*text) ? parse_tm33(*text, inner, std::nullopt) : parse_photometric_text(*text, inner);
  if (!out) return out;
  if (light->rated_lm) out->intensity = scaled_to_flux(std::move(out->intensity), *light->rated_lm);
  if (light->input_w) out->input_w = *light->input_w;
  out->warnings.insert(out->warnings.end(), light->warnings.begin(), light->warnings.end());
  return out;
}

}  // namespace luxrig
