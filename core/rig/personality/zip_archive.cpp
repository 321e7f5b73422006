#include "core/rig/personality/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cctype>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxInflation = 1000;      // deflate can reach 1032; real descriptions reach 30
constexpr std::size_t kFreeOfRatio = 64 * 1024;  // an entry this small is not a bomb

tl::unexpected<std::vector<Problem>> refuse_zip(const std::string& file, std::string what, std::string mend) {
  return tl::unexpected(std::vector<Problem>{{file, 0, 0, std::move(what), std::move(mend)}});
}

bool same_but_for_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

}  // namespace

struct ZipArchive::Handle {
  explicit Handle(std::string content) : bytes(std::move(content)) {}
  ~Handle() {
    if (zip != nullptr) zip_discard(zip);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  std::string bytes;  // libzip reads from it
  zip_t* zip = nullptr;
};

Checked<ZipArchive> ZipArchive::open(std::string bytes, const std::string& file) {
  if (bytes.size() > kMaxZipBytes) {
    return refuse_zip(file, fmt::format("the archive has {} bytes", bytes.size()),
                      fmt::format("it may have at most {} MiB", kMaxZipBytes >> 20));
  }
  ZipArchive archive;
  archive.file_ = file;
  archive.handle_ = std::make_shared<Handle>(std::move(bytes));
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source =
      zip_source_buffer_create(archive.handle_->bytes.data(), archive.handle_->bytes.size(), 0, &error);
  if (source != nullptr) {
    archive.handle_->zip = zip_open_from_source(source, ZIP_RDONLY, &error);
    if (archive.handle_->zip == nullptr) zip_source_free(source);
  }
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive.handle_->zip == nullptr) {
    return refuse_zip(file, "not a zip archive (" + made_plain(why) + ")",
                      "GDTF and MVR files are zip archives; get the file again from where it came");
  }
  const zip_int64_t count = zip_get_num_entries(archive.handle_->zip, 0);
  if (count < 0 || static_cast<std::size_t>(count) > kMaxZipEntries) {
    return refuse_zip(file, fmt::format("the archive has {} entries", count),
                      fmt::format("it may have at most {}", kMaxZipEntries));
  }
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive.handle_->zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    archive.names_.emplace_back(name == nullptr ? "" : name);
  }
  return archive;
}

const std::string* ZipArchive::find(std::string_view name, std::string_view extension) const {
  const auto matching = [&](auto&& matches) -> const std::string* {
    const auto at = std::find_if(names_.begin(), names_.end(), [&](const std::string& entry) {
      return entry.find_first_of("/\\") == std::string::npos && matches(entry);
    });
    return at == names_.end() ? nullptr : &*at;
  };
  if (const auto* exact = matching([&](const std::string& entry) { return entry == name; })) return exact;
  if (const auto* near = matching([&](const std::string& entry) { return same_but_for_case(entry, name); }))
    return near;
  if (extension.empty()) return nullptr;
  const std::string longer = std::string(name) + std::string(extension);
  return matching([&](const std::string& entry) { return same_but_for_case(entry, longer); });
}

Checked<std::string> ZipArchive::read(const std::string& name, std::size_t max_bytes) const {
  const auto at = std::find(names_.begin(), names_.end(), name);
  if (at == names_.end()) return refuse_zip(file_, in_quotes(name) + " is not in the archive", "add it");
  const auto index = static_cast<zip_uint64_t>(at - names_.begin());
  zip_stat_t stat;
  zip_stat_init(&stat);
  const bool known = zip_stat_index(handle_->zip, index, 0, &stat) == 0;
  if (known && (stat.valid & ZIP_STAT_ENCRYPTION_METHOD) && stat.encryption_method != ZIP_EM_NONE)
    return refuse_zip(file_, in_quotes(name) + " is encrypted", "pack the archive without a password");
  std::size_t most = max_bytes;
  if (known && (stat.valid & ZIP_STAT_COMP_SIZE)) {
    const std::size_t packed = std::min<std::size_t>(stat.comp_size, kMaxZipBytes);
    most = std::min(most, std::max(kFreeOfRatio, packed * kMaxInflation));
  }
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> in(zip_fopen_index(handle_->zip, index, 0), zip_fclose);
  if (!in) {
    return refuse_zip(
        file_, fmt::format("{} cannot be unpacked ({})", in_quotes(name), made_plain(zip_strerror(handle_->zip))),
        "pack the archive again, stored or deflated");
  }
  std::string content;
  char chunk[32 * 1024];
  for (;;) {
    const zip_int64_t got = zip_fread(in.get(), chunk, sizeof chunk);
    if (got < 0) {
      return refuse_zip(file_, in_quotes(name) + " is damaged in the archive",
                        "get the file again from where it came, or pack it anew");
    }
    if (got == 0) break;
    if (content.size() + static_cast<std::size_t>(got) > most) {
      return refuse_zip(file_, fmt::format("{} unpacks to more than {} bytes", in_quotes(name), most),
                        "a file of this kind is smaller; do not trust it");
    }
    content.append(chunk, static_cast<std::size_t>(got));
  }
  return content;
}

}  // namespace luxrig
