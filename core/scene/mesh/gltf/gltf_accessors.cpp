#include "core/scene/mesh/gltf/gltf_accessors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/scene/mesh/mesh_text.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxBufferBytes = std::size_t{8} << 30;
constexpr std::size_t kMaxRows = 150'000'000, kMaxRowsOfNothing = 1'000'000;

std::size_t bytes_of_type(int type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return 0;
}

GltfRefusal broken(std::string what) { return {std::move(what), "export it again"}; }

std::optional<std::string> from_base64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    int value = 0;
    if (c >= 'A' && c <= 'Z') {
      value = c - 'A';
    } else if (c >= 'a' && c <= 'z') {
      value = c - 'a' + 26;
    } else if (c >= '0' && c <= '9') {
      value = c - '0' + 52;
    } else if (c == '+' || c == '-') {
      value = 62;
    } else if (c == '/' || c == '_') {
      value = 63;
    } else {
      return std::nullopt;
    }
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out += static_cast<char>(bits >> have & 0xff);
  }
  return out;
}

}  // namespace

const nlohmann::json* member_of(const nlohmann::json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

std::optional<std::size_t> index_member(const nlohmann::json& object, const char* name) {
  const nlohmann::json* const value = member_of(object, name);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  const double number = value->get<double>();  // some exporters write 3.0
  if (!(number >= 0 && number < 9e15) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::size_t>(number);
}

double number_member(const nlohmann::json& object, const char* name, double otherwise) {
  const nlohmann::json* const value = member_of(object, name);
  return value != nullptr && value->is_number() ? value->get<double>() : otherwise;
}

std::string text_member(const nlohmann::json& object, const char* name) {
  const nlohmann::json* const value = member_of(object, name);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::optional<std::vector<double>> numbers_member(const nlohmann::json& object, const char* name, std::size_t count) {
  const nlohmann::json* const value = member_of(object, name);
  if (value == nullptr || !value->is_array() || value->size() != count) return std::nullopt;
  std::vector<double> out;
  for (const nlohmann::json& one : *value) {
    if (!one.is_number()) return std::nullopt;
    out.push_back(one.get<double>());
  }
  return out;
}

double Accessor::value(const char* bytes) const {
  const auto as = [&]<class T>(T number, double most) {
    std::memcpy(&number, bytes, sizeof number);
    return normalised_ ? std::max(static_cast<double>(number) / most, -1.0) : static_cast<double>(number);
  };
  switch (type_) {
    case 5120:
      return as(std::int8_t{}, 127);
    case 5121:
      return as(std::uint8_t{}, 255);
    case 5122:
      return as(std::int16_t{}, 32767);
    case 5123:
      return as(std::uint16_t{}, 65535);
    case 5125:
      return as(std::uint32_t{}, 4294967295.0);
    default:
      return as(float{}, 1);
  }
}

double Accessor::at(std::size_t row, std::size_t component) const {
  const std::size_t bytes = bytes_of_type(type_);
  if (!sparse_.empty()) {
    if (const auto found = sparse_.find(row); found != sparse_.end())
      return value(&sparse_bytes_[(found->second * components_ + component) * bytes]);
  }
  return bytes_.empty() ? 0 : value(&bytes_[row * stride_ + component * bytes]);
}

std::uint32_t Accessor::index_at(std::size_t row) const { return static_cast<std::uint32_t>(at(row, 0)); }

Checked<GltfDocument> GltfDocument::open(std::string bytes, const std::string& file, const FilesBeside& beside) {
  const auto refuse = [&](int line, int column, std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{file, line, column, std::move(what), std::move(mend)}});
  };
  GltfDocument out;
  out.beside_ = &beside;
  std::string text;
  const bool binary = bytes.starts_with("glTF");
  if (binary) {
    out.file_bytes_ = std::move(bytes);  // long enough that views into it survive a move
    const std::string_view all = out.file_bytes_;
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      if (at + 4 <= all.size()) std::memcpy(&value, &all[at], 4);
      return std::size_t{value};
    };
    if (all.size() < 20) return refuse(0, 0, "is cut short", "give the whole file");
    if (word(4) != 2) return refuse(0, 0, "is a GLB of version " + std::to_string(word(4)), "export it as glTF 2.0");
    if (word(8) > all.size()) {
      return refuse(
          0, 0, "is cut short: it promises " + std::to_string(word(8)) + " bytes and has " + std::to_string(all.size()),
          "give the whole file");
    }
    bool has_json = false;
    for (std::size_t at = 12; at + 8 <= all.size();) {
      const std::size_t size = word(at), kind = word(at + 4);
      at += 8;
      if (size > all.size() - at) return refuse(0, 0, "is cut short within a chunk", "give the whole file");
      if (kind == 0x4E4F534A && !has_json) {
        text = std::string(all.substr(at, size));
        has_json = true;
      } else if (kind == 0x004E4942 && out.binary_.empty()) {
        out.binary_ = all.substr(at, size);
      }
      at += size;
    }
  } else {
    text = utf8_of(std::move(bytes));
  }
  try {
    out.root_ = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
    const std::string_view before = std::string_view(text).substr(0, end);
    const auto newline = before.rfind('\n');
    const int line = binary ? 0 : static_cast<int>(std::count(before.begin(), before.end(), '\n')) + 1;
    const auto column = newline == std::string_view::npos ? before.size() + 1 : before.size() - newline;
    return refuse(line, binary ? 0 : static_cast<int>(std::min<std::size_t>(column, 1'000'000'000)),
                  "is no JSON from here on", "export it again as glTF 2.0");
  } catch (const nlohmann::json::exception&) {  // a number beyond double
    return refuse(0, 0, "has a number too large for any computer", "export it again as glTF 2.0");
  }
  const nlohmann::json* const asset = member_of(out.root_, "asset");
  const std::string version = asset != nullptr ? text_member(*asset, "version") : "";
  if (!version.starts_with("2")) {
    return refuse(0, 0, version.empty() ? "is no glTF: it states no version" : "is glTF " + in_quotes(version),
                  "export it as glTF 2.0");
  }
  return out;
}

const nlohmann::json* GltfDocument::entry(const char* array, std::size_t index) const {
  const nlohmann::json* const all = member_of(root_, array);
  return all != nullptr && all->is_array() && index < all->size() ? &(*all)[index] : nullptr;
}

std::string GltfDocument::name_of_uri(const std::string& uri) {
  std::string name;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      name += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

std::optional<std::string> GltfDocument::data_of_uri(const std::string& uri) {
  const auto comma = uri.find(',');
  if (!uri.starts_with("data:") || comma == std::string::npos || uri.find(";base64") > comma) return std::nullopt;
  return from_base64(std::string_view(uri).substr(comma + 1));
}

tl::expected<std::string_view, GltfRefusal> GltfDocument::buffer(std::size_t index) {
  if (const auto known = buffers_.find(index); known != buffers_.end()) return std::string_view(known->second);
  const nlohmann::json* const one = entry("buffers", index);
  if (one == nullptr) return tl::unexpected(broken("names buffer " + std::to_string(index) + ", which is not there"));
  const std::string uri = text_member(*one, "uri");
  if (uri.empty() && index == 0) return binary_;
  std::optional<std::string> bytes =
      uri.starts_with("data:") ? data_of_uri(uri) : beside_->read(name_of_uri(uri), kMaxBufferBytes);
  if (!bytes) {
    return tl::unexpected(uri.starts_with("data:")
                              ? broken("has a buffer that is no base64")
                              : GltfRefusal{"names " + in_quotes(name_of_uri(uri)) + ", which is not beside it",
                                            "put that file there, or export it as .glb, which is one file"});
  }
  return std::string_view(buffers_.emplace(index, std::move(*bytes)).first->second);
}

GltfRefusal unread_extension(const std::string& name) {
  if (name == "KHR_draco_mesh_compression")
    return {"compresses its mesh by KHR_draco_mesh_compression, which is not read",
            "export it without compression (Blender: Data > Compression off)"};
  if (name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression")
    return {"compresses its mesh by " + name + ", which is not read",
            "export it without compression (gltfpack: leave out -c and -cc)"};
  return {"requires " + in_quotes(name) + ", which is not known", "export it without that extension"};
}

tl::expected<std::string_view, GltfRefusal> GltfDocument::view(std::size_t index) {
  const nlohmann::json* const one = entry("bufferViews", index);
  if (one == nullptr)
    return tl::unexpected(broken("names buffer view " + std::to_string(index) + ", which is not there"));
  const auto in = index_member(*one, "buffer"), length = index_member(*one, "byteLength");
  const std::size_t offset = index_member(*one, "byteOffset").value_or(0);
  if (!in || !length)
    return tl::unexpected(broken("has buffer view " + std::to_string(index) + " without a buffer and a length"));
  // meshopt's data is elsewhere; this buffer is only a placeholder, unless the exporter filled it.
  const nlohmann::json* const extensions = member_of(*one, "extensions");
  const nlohmann::json* const stated = entry("buffers", *in);
  for (const char* const name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (extensions == nullptr || stated == nullptr || member_of(*extensions, name) == nullptr) continue;
    if (text_member(*stated, "uri").empty() && (*in > 0 || member_of(*stated, "extensions") != nullptr))
      return tl::unexpected(unread_extension(name));
  }
  const auto bytes = buffer(*in);
  if (!bytes) return tl::unexpected(bytes.error());
  if (offset > bytes->size() || *length > bytes->size() - offset)
    return tl::unexpected(GltfRefusal{"has buffer view " + std::to_string(index) + " past the end of its buffer",
                                      "give the whole file, or export it again"});
  return bytes->substr(offset, *length);
}

tl::expected<Accessor, GltfRefusal> GltfDocument::accessor(std::size_t index) {
  const std::string name = "accessor " + std::to_string(index);
  const nlohmann::json* const one = entry("accessors", index);
  if (one == nullptr) return tl::unexpected(broken("names " + name + ", which is not there"));
  Accessor out;
  const auto count = index_member(*one, "count");
  out.type_ = static_cast<int>(std::min<std::size_t>(index_member(*one, "componentType").value_or(0), 100'000));
  out.components_ = components_of(text_member(*one, "type"));
  const std::size_t size = bytes_of_type(out.type_) * out.components_;
  if (!count || size == 0)
    return tl::unexpected(broken("has " + name + " without a count, a component type and a type"));
  if (*count > kMaxRows)
    return tl::unexpected(GltfRefusal{"has more than 150 million corners", "give a simplified mesh"});
  out.count_ = *count;
  const nlohmann::json* const normalised = member_of(*one, "normalized");
  out.normalised_ = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>() && out.type_ != 5126;
  if (const auto in = index_member(*one, "bufferView")) {
    const auto bytes = view(*in);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::size_t offset = index_member(*one, "byteOffset").value_or(0);
    const std::size_t stride = index_member(*entry("bufferViews", *in), "byteStride").value_or(0);
    out.stride_ = stride == 0 ? size : stride;
    if (out.stride_ < size || out.stride_ > 65536 ||
        (out.count_ > 0 && (offset > bytes->size() || bytes->size() - offset < size ||
                            (bytes->size() - offset - size) / out.stride_ < out.count_ - 1)))
      return tl::unexpected(broken("has " + name + " past the end of its buffer view"));
    out.bytes_ = bytes->substr(std::min(offset, bytes->size()));
  } else if (out.count_ > kMaxRowsOfNothing) {
    return tl::unexpected(broken("has " + name + " of a million zeros"));
  }
  const nlohmann::json* const sparse = member_of(*one, "sparse");
  if (sparse == nullptr) return out;
  const auto changed = index_member(*sparse, "count");
  const nlohmann::json* const indices = member_of(*sparse, "indices");
  const nlohmann::json* const values = member_of(*sparse, "values");
  const auto index_view = indices != nullptr ? index_member(*indices, "bufferView") : std::nullopt;
  const auto value_view = values != nullptr ? index_member(*values, "bufferView") : std::nullopt;
  if (!changed || !index_view || !value_view || *changed > out.count_)
    return tl::unexpected(broken("has " + name + " with a sparse part that is incomplete"));
  const auto index_bytes = view(*index_view), value_bytes = view(*value_view);
  if (!index_bytes) return tl::unexpected(index_bytes.error());
  if (!value_bytes) return tl::unexpected(value_bytes.error());
  Accessor rows;
  rows.type_ = static_cast<int>(std::min<std::size_t>(index_member(*indices, "componentType").value_or(0), 100'000));
  const std::size_t index_size = bytes_of_type(rows.type_);
  const std::size_t index_offset = index_member(*indices, "byteOffset").value_or(0);
  const std::size_t value_offset = index_member(*values, "byteOffset").value_or(0);
  if (index_size == 0 || rows.type_ == 5126 || index_offset > index_bytes->size() ||
      (index_bytes->size() - index_offset) / index_size < *changed || value_offset > value_bytes->size() ||
      (value_bytes->size() - value_offset) / size < *changed)
    return tl::unexpected(broken("has " + name + " with a sparse part past the end of its buffer view"));
  for (std::size_t i = 0; i < *changed; ++i) {
    const double row = rows.value(&(*index_bytes)[index_offset + i * index_size]);
    if (row >= 0 && row < static_cast<double>(out.count_)) out.sparse_[static_cast<std::size_t>(row)] = i;
  }
  out.sparse_bytes_ = value_bytes->substr(value_offset);
  return out;
}

}  // namespace luxrig
