// Converts bytes and messages between Python and the core.
#pragma once
#include <nanobind/nanobind.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "link/dictionary.hpp"
#include "link/frame.hpp"

namespace passo::wire {

using FormatList = std::vector<std::pair<int32_t, std::string>>;

inline const uint8_t* data_of(const nanobind::bytes& b) {
  return reinterpret_cast<const uint8_t*>(b.c_str());
}
inline nanobind::bytes to_bytes(const void* data, size_t size) {
  return nanobind::bytes(static_cast<const char*>(data), size);
}
inline Bytes from_bytes(const nanobind::bytes& b) {
  return Bytes(data_of(b), data_of(b) + b.size());
}

inline Formats make_formats(const FormatList& list) {
  Formats formats;
  for (const auto& [id, text] : list) formats.add(id, text);
  return formats;
}
inline std::vector<Value> to_values(const nanobind::list& list) {
  std::vector<Value> values;
  for (nanobind::handle item : list) {
    if (nanobind::isinstance<nanobind::bytes>(item)) {
      auto blob = nanobind::cast<nanobind::bytes>(item);
      values.emplace_back(std::string(blob.c_str(), blob.size()));
    } else {
      values.emplace_back(nanobind::cast<int64_t>(item));
    }
  }
  return values;
}
inline nanobind::dict to_dict(const Format& format, const std::vector<Value>& values) {
  nanobind::dict dict;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto& name = format.parameters[i].name;
    if (const auto* number = std::get_if<int64_t>(&values[i]))
      dict[name.c_str()] = *number;
    else
      dict[name.c_str()] = to_bytes(std::get<std::string>(values[i]).data(),
                                    std::get<std::string>(values[i]).size());
  }
  return dict;
}

}  // namespace passo::wire
