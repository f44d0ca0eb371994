#pragma once
// Every key that an animation file may have.
#include <array>
#include <string_view>

/// Keys of each kind of object; a test holds docs/animation-file.schema.json against them.
namespace render2mpeg::scene::animation_file_keys {

using K = std::string_view;

inline constexpr std::array film{
    K("$schema"), K("title"),      K("scene"),   K("size"),          K("display_aspect"),  K("frame_rate"),
    K("frames"),  K("seconds"),    K("times"),   K("sky"),           K("exposure"),        K("camera"),
    K("cameras"), K("shots"),      K("lights"),  K("objects"),       K("materials"),       K("change"),
    K("sound"),   K("view"),       K("shutter"), K("shutter_phase"), K("rolling_shutter"), K("glare"),
    K("fog"),     K("transparent")};

inline constexpr std::array fog{K("visibility"), K("color"), K("anisotropy"), K("height"), K("falloff")};

inline constexpr std::array glare{K("kind"), K("strength"), K("size"), K("seed")};

inline constexpr std::array view{K("name"), K("gamma")};

inline constexpr std::array camera{
    K("position"),      K("look_at"),       K("rotate"), K("roll"),           K("fov"),    K("height"),
    K("interpolation"), K("keys"),          K("loop"),   K("near"),           K("shift"),  K("f_stop"),
    K("focus"),         K("sensor_height"), K("blades"), K("blade_rotation"), K("squeeze")};
inline constexpr std::array camera_key{K("at"),   K("position"), K("look_at"), K("rotate"),
                                       K("roll"), K("fov"),      K("f_stop"),  K("focus")};

inline constexpr std::array shot{K("at"), K("camera")};

inline constexpr std::array light{K("name"),      K("kind"),          K("color"),  K("intensity"), K("range"),
                                  K("position"),  K("look_at"),       K("rotate"), K("angle"),     K("softness"),
                                  K("elevation"), K("azimuth"),       K("size"),   K("radius"),    K("power"),
                                  K("keys"),      K("interpolation"), K("loop"),   K("repeat"),    K("colors"),
                                  K("stagger"),   K("seen"),          K("round")};
inline constexpr std::array light_key{K("at"), K("position"), K("look_at"), K("rotate"), K("power")};

inline constexpr std::array object{
    K("name"),          K("shape"),    K("size"),     K("radius"),   K("top_radius"), K("tube_radius"), K("height"),
    K("opening"),       K("profile"),  K("crease"),   K("segments"), K("strands"),    K("tip_radius"),  K("uv"),
    K("parts"),         K("material"), K("position"), K("rotate"),   K("scale"),      K("visible"),     K("keys"),
    K("interpolation"), K("loop"),     K("repeat"),   K("colors"),   K("reflections")};
inline constexpr std::array object_key{K("at"), K("position"), K("rotate"), K("scale"), K("visible"), K("reflections")};
inline constexpr std::array reflection{K("at"), K("see"), K("radius"), K("border")};

inline constexpr std::array change{K("position"),      K("rotate"), K("scale"),    K("visible"),    K("keys"),
                                   K("interpolation"), K("loop"),   K("material"), K("reflections")};

inline constexpr std::array repeat{K("count"), K("step"), K("centered"), K("ring")};
inline constexpr std::array ring{K("count"), K("radius"), K("from"), K("to")};

inline constexpr std::array material{K("base_color"),
                                     K("texture"),
                                     K("texture_scale"),
                                     K("alpha"),
                                     K("alpha_cutoff"),
                                     K("metallic"),
                                     K("roughness"),
                                     K("normal_texture"),
                                     K("normal_scale"),
                                     K("emission"),
                                     K("emission_texture"),
                                     K("transmission"),
                                     K("ior"),
                                     K("solid"),
                                     K("attenuation"),
                                     K("attenuation_distance"),
                                     K("dispersion"),
                                     K("hair"),
                                     K("subsurface"),
                                     K("double_sided"),
                                     K("unlit"),
                                     K("holdout"),
                                     K("power"),
                                     K("keys"),
                                     K("interpolation"),
                                     K("loop")};
inline constexpr std::array hair{K("color"),   K("absorption"), K("melanin"),
                                 K("redness"), K("roughness"),  K("azimuthal_roughness"),
                                 K("coat"),    K("ior"),        K("tilt")};

inline constexpr std::array subsurface{K("weight"), K("free_path")};

inline constexpr std::array material_key{K("at"), K("power")};

inline constexpr std::array checker{K("checker"), K("squares")};

inline constexpr std::array sky{K("color"),  K("image"),   K("rotation"), K("strength"),
                                K("zenith"), K("horizon"), K("ground")};

}  // namespace render2mpeg::scene::animation_file_keys
