#include "tools/luxrigd/api/openapi.h"

#include <algorithm>
#include <map>

#include "tools/luxrigd/api/route_table.h"
#include "tools/luxrigd/api/status_schema.h"

namespace luxrig {
namespace {

using schema::Schema;

Schema content_with(const char* type, const Schema& body) {
  return {{type, body.is_null() ? Schema::object() : Schema{{"schema", body}}}};
}

Schema response(const ApiAnswer& answer) {
  Schema out = {{"description", answer.what}};
  if (answer.content_type) out["content"] = content_with(answer.content_type, answer.body);
  return out;
}

Schema parameter(const char* where, const char* name, const char* what) {
  return {{"name", name}, {"in", where}, {"description", what}, {"schema", {{"type", "string"}}}};
}

std::string name_of_refusal(const ApiAnswer& refusal) { return "refusal-" + std::to_string(refusal.status); }

/// Ascending by status.
Schema responses_of(const ApiRoute& route) {
  std::map<int, Schema> all;
  for (const ApiAnswer& one : common_refusals(route))
    all[one.status] = {{"$ref", "#/components/responses/" + name_of_refusal(one)}};
  for (const ApiAnswer& one : route.answers) all[one.status] = response(one);
  Schema out;
  for (const auto& [status, one] : all) out[std::to_string(status)] = one;
  return out;
}

/// "POST", "/api/hand-back" -> "postHandBack".
std::string id_of(const ApiRoute& route) {
  std::string id;
  for (const char* c = route.method; *c != '\0'; ++c) id += static_cast<char>(*c - 'A' + 'a');
  bool capital = true;
  for (const char c : std::string(route.path).substr(4)) {
    const bool letter = c >= 'a' && c <= 'z';
    if (letter) id += capital ? static_cast<char>(c - 'a' + 'A') : c;
    capital = !letter;
  }
  return id;
}

Schema operation(const ApiRoute& route) {
  Schema out = {{"operationId", id_of(route)},
                {"summary", route.does},
                {"x-role", name_of(route.role)},
                {"security", Schema::array()}};
  if (route.role != Role::anybody)
    for (const char* scheme : {"token", "cookie"}) out["security"].push_back({{scheme, Schema::array()}});
  if (const std::string path = route.path; path.back() == '}') {
    const std::size_t brace = path.find('{');
    out["parameters"].push_back(
        parameter("path", path.substr(brace + 1, path.size() - brace - 2).c_str(), "which one, percent-encoded"));
    out["parameters"].back()["required"] = true;
  }
  for (const ApiParameter& one : route.parameters) out["parameters"].push_back(parameter("query", one.name, one.what));
  if (route.kept)
    out["parameters"].push_back(parameter("header", "If-None-Match", "ETag of the answer that the client has"));
  if (route.matched)
    out["parameters"].push_back(parameter("header", "If-Match", "ETag of the state that the client has changed"));
  if (!route.body.is_null())
    out["requestBody"] = {{"required", true},
                          {"x-max-bytes", route.max_body_bytes},
                          {"content", content_with("application/json", route.body)}};
  out["responses"] = responses_of(route);
  return out;
}

}  // namespace

std::string openapi_json() {
  Schema paths;
  for (const ApiRoute& route : route_table()) {
    std::string method = route.method;
    std::transform(method.begin(), method.end(), method.begin(),
                   [](char c) { return static_cast<char>(c - 'A' + 'a'); });
    paths[route.path][method] = operation(route);
  }
  Schema schemas = status_schemas(), refusals;
  for (const ApiRoute& route : route_table())
    for (const ApiAnswer& one : common_refusals(route)) refusals[name_of_refusal(one)] = response(one);
  schemas["Refusal"] = schema::answer({{"error", schema::text("why, for a person")}});
  schemas["Plan"] = schema::said({{"type", "object"}}, "a plan as luxrig solve -o writes it");
  const Schema out = {
      {"openapi", "3.1.0"},
      {"info",
       {{"title", "luxrigd"},
        {"version", LUXRIG_VERSION},
        {"summary", "a lighting rig that is lit to its goals, measured, corrected and held"},
        {"description",
         "API.md beside this file says what each of them means. Later versions add keys and routes, and rename none. A "
         "POST without a body of its own may have one, which is not read."},
        {"license", {{"name", "Apache-2.0"}, {"identifier", "Apache-2.0"}}}}},
      {"servers", {{{"url", "http://127.0.0.1:9620"}}}},
      {"paths", paths},
      {"components",
       {{"securitySchemes",
         {{"token", {{"type", "http"}, {"scheme", "bearer"}}},
          {"cookie",
           {{"type", "apiKey"},
            {"in", "cookie"},
            {"name", "luxrig_session_9620"},
            {"description", "the name ends with the port"}}}}},
        {"responses", refusals},
        {"schemas", schemas}}}};
  return out.dump(2) + "\n";
}

}  // namespace luxrig
