#pragma once

#include <span>
#include <string>

#include "core/error.h"
#include "encoded.h"
#include "image/image.h"

/// Reads files that tests make in memory.
namespace render2mpeg::image::test {

inline Image read(const encoded::Bytes& bytes, const std::string& name = "test") {
    return read_image({}, std::as_bytes(std::span(bytes)), name);
}

/// What is said of a file that cannot be read; empty where it can.
inline std::string refusal(const encoded::Bytes& bytes, const std::string& name = "test.png") {
    try {
        read(bytes, name);
    } catch (const core::Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace render2mpeg::image::test
