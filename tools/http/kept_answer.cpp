#include "tools/http/kept_answer.h"

#include <fmt/format.h>
#include <zlib.h>

#include <string_view>

#include "core/check.h"
#include "core/fingerprint.h"

namespace luxrig {
namespace {

constexpr int kGzip = 16;  // of zlib's window bits: gzip's header instead of zlib's

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  LUXRIG_CHECK(
      ::deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_DEFAULT_STRATEGY) == Z_OK,
      "zlib");
  std::string out(::deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int ended = ::deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  ::deflateEnd(&stream);
  LUXRIG_CHECK(ended == Z_STREAM_END, "zlib: {}", ended);
  return out;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t");
  return from == std::string_view::npos ? "" : text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

/// Calls `with` for each entry of a list in a header.
template <class With>
void each_entry(std::string_view list, With with) {
  while (!list.empty()) {
    const std::string_view entry = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), entry.size() + 1));
    with(trimmed(entry));
  }
}

bool takes_gzip(const HttpRequest& request) {
  bool takes = false;
  for (const auto& [name, value] : request.headers) {
    if (name != "accept-encoding") continue;
    each_entry(value, [&](std::string_view entry) {
      const std::string_view coding = trimmed(entry.substr(0, entry.find(';')));
      if (coding != "gzip" && coding != "x-gzip" && coding != "*") return;
      const std::size_t weight = entry.find("q=");
      // "q=0", "q=0.0", "q=0.000": not at all.
      takes = takes || weight == std::string_view::npos ||
              entry.find_first_not_of("0. \t", weight + 2) != std::string_view::npos;
    });
  }
  return takes;
}

bool has_already(const HttpRequest& request, std::string_view etag) {
  bool has = false;
  for (const auto& [name, value] : request.headers) {
    if (name != "if-none-match") continue;
    each_entry(value, [&](std::string_view entry) {
      if (entry.substr(0, 2) == "W/") entry.remove_prefix(2);
      has = has || entry == "*" || entry == etag;
    });
  }
  return has;
}

}  // namespace

KeptAnswer kept_answer(std::string content_type, std::string body) {
  KeptAnswer kept{std::move(content_type), std::move(body), {}, {}};
  kept.gzip = gzipped(kept.body);
  Fingerprint print;
  print.add(std::string_view(kept.body));
  kept.etag = fmt::format("{:016x}", print.value());
  return kept;
}

HttpResponse answer_with(const KeptAnswer& kept, const HttpRequest& request) {
  const bool gzip = takes_gzip(request);
  const std::string etag = fmt::format("\"{}{}\"", kept.etag, gzip ? "-gzip" : "");
  HttpHeaders headers = {{"ETag", etag}, {"Cache-Control", "private, no-cache"}, {"Vary", "Accept-Encoding"}};
  if (has_already(request, etag)) return {304, {}, {}, std::move(headers)};
  if (gzip) headers.emplace_back("Content-Encoding", "gzip");
  return {200, kept.content_type, gzip ? kept.gzip : kept.body, std::move(headers)};
}

}  // namespace luxrig
