#pragma once
// The OpenGL functions that we call, loaded from the current context by name.

#include <GL/glcorearb.h>

#include "geometry/result.h"

namespace promenade {

/// X(member, type, name): OpenGL 3.3 core, all required.
#define PROMENADE_GL_FUNCTIONS(X)                                                              \
  X(active_texture, PFNGLACTIVETEXTUREPROC, "glActiveTexture")                                 \
  X(attach_shader, PFNGLATTACHSHADERPROC, "glAttachShader")                                    \
  X(bind_buffer, PFNGLBINDBUFFERPROC, "glBindBuffer")                                          \
  X(bind_frag_data_location, PFNGLBINDFRAGDATALOCATIONPROC, "glBindFragDataLocation")          \
  X(bind_framebuffer, PFNGLBINDFRAMEBUFFERPROC, "glBindFramebuffer")                           \
  X(bind_renderbuffer, PFNGLBINDRENDERBUFFERPROC, "glBindRenderbuffer")                        \
  X(bind_sampler, PFNGLBINDSAMPLERPROC, "glBindSampler")                                       \
  X(bind_texture, PFNGLBINDTEXTUREPROC, "glBindTexture")                                       \
  X(bind_vertex_array, PFNGLBINDVERTEXARRAYPROC, "glBindVertexArray")                          \
  X(blend_func_separate, PFNGLBLENDFUNCSEPARATEPROC, "glBlendFuncSeparate")                    \
  X(blit_framebuffer, PFNGLBLITFRAMEBUFFERPROC, "glBlitFramebuffer")                           \
  X(buffer_data, PFNGLBUFFERDATAPROC, "glBufferData")                                          \
  X(check_framebuffer_status, PFNGLCHECKFRAMEBUFFERSTATUSPROC, "glCheckFramebufferStatus")     \
  X(clear_bufferfv, PFNGLCLEARBUFFERFVPROC, "glClearBufferfv")                                 \
  X(clear_bufferuiv, PFNGLCLEARBUFFERUIVPROC, "glClearBufferuiv")                              \
  X(compile_shader, PFNGLCOMPILESHADERPROC, "glCompileShader")                                 \
  X(create_program, PFNGLCREATEPROGRAMPROC, "glCreateProgram")                                 \
  X(create_shader, PFNGLCREATESHADERPROC, "glCreateShader")                                    \
  X(delete_buffers, PFNGLDELETEBUFFERSPROC, "glDeleteBuffers")                                 \
  X(delete_framebuffers, PFNGLDELETEFRAMEBUFFERSPROC, "glDeleteFramebuffers")                  \
  X(delete_program, PFNGLDELETEPROGRAMPROC, "glDeleteProgram")                                 \
  X(delete_renderbuffers, PFNGLDELETERENDERBUFFERSPROC, "glDeleteRenderbuffers")               \
  X(delete_samplers, PFNGLDELETESAMPLERSPROC, "glDeleteSamplers")                              \
  X(delete_shader, PFNGLDELETESHADERPROC, "glDeleteShader")                                    \
  X(delete_textures, PFNGLDELETETEXTURESPROC, "glDeleteTextures")                              \
  X(delete_vertex_arrays, PFNGLDELETEVERTEXARRAYSPROC, "glDeleteVertexArrays")                 \
  X(depth_func, PFNGLDEPTHFUNCPROC, "glDepthFunc")                                             \
  X(depth_mask, PFNGLDEPTHMASKPROC, "glDepthMask")                                             \
  X(disable, PFNGLDISABLEPROC, "glDisable")                                                    \
  X(draw_arrays, PFNGLDRAWARRAYSPROC, "glDrawArrays")                                          \
  X(draw_elements, PFNGLDRAWELEMENTSPROC, "glDrawElements")                                    \
  X(enable, PFNGLENABLEPROC, "glEnable")                                                       \
  X(enable_vertex_attrib_array, PFNGLENABLEVERTEXATTRIBARRAYPROC, "glEnableVertexAttribArray") \
  X(finish, PFNGLFINISHPROC, "glFinish")                                                       \
  X(framebuffer_renderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC, "glFramebufferRenderbuffer")   \
  X(framebuffer_texture_2d, PFNGLFRAMEBUFFERTEXTURE2DPROC, "glFramebufferTexture2D")           \
  X(front_face, PFNGLFRONTFACEPROC, "glFrontFace")                                             \
  X(gen_buffers, PFNGLGENBUFFERSPROC, "glGenBuffers")                                          \
  X(gen_framebuffers, PFNGLGENFRAMEBUFFERSPROC, "glGenFramebuffers")                           \
  X(gen_renderbuffers, PFNGLGENRENDERBUFFERSPROC, "glGenRenderbuffers")                        \
  X(gen_samplers, PFNGLGENSAMPLERSPROC, "glGenSamplers")                                       \
  X(gen_textures, PFNGLGENTEXTURESPROC, "glGenTextures")                                       \
  X(gen_vertex_arrays, PFNGLGENVERTEXARRAYSPROC, "glGenVertexArrays")                          \
  X(get_error, PFNGLGETERRORPROC, "glGetError")                                                \
  X(get_floatv, PFNGLGETFLOATVPROC, "glGetFloatv")                                             \
  X(get_integerv, PFNGLGETINTEGERVPROC, "glGetIntegerv")                                       \
  X(get_program_info_log, PFNGLGETPROGRAMINFOLOGPROC, "glGetProgramInfoLog")                   \
  X(get_programiv, PFNGLGETPROGRAMIVPROC, "glGetProgramiv")                                    \
  X(get_shader_info_log, PFNGLGETSHADERINFOLOGPROC, "glGetShaderInfoLog")                      \
  X(get_shaderiv, PFNGLGETSHADERIVPROC, "glGetShaderiv")                                       \
  X(get_string, PFNGLGETSTRINGPROC, "glGetString")                                             \
  X(get_stringi, PFNGLGETSTRINGIPROC, "glGetStringi")                                          \
  X(get_uniform_location, PFNGLGETUNIFORMLOCATIONPROC, "glGetUniformLocation")                 \
  X(link_program, PFNGLLINKPROGRAMPROC, "glLinkProgram")                                       \
  X(pixel_storei, PFNGLPIXELSTOREIPROC, "glPixelStorei")                                       \
  X(read_buffer, PFNGLREADBUFFERPROC, "glReadBuffer")                                          \
  X(read_pixels, PFNGLREADPIXELSPROC, "glReadPixels")                                          \
  X(renderbuffer_storage, PFNGLRENDERBUFFERSTORAGEPROC, "glRenderbufferStorage")               \
  X(sampler_parameterf, PFNGLSAMPLERPARAMETERFPROC, "glSamplerParameterf")                     \
  X(sampler_parameteri, PFNGLSAMPLERPARAMETERIPROC, "glSamplerParameteri")                     \
  X(shader_source, PFNGLSHADERSOURCEPROC, "glShaderSource")                                    \
  X(tex_image_2d, PFNGLTEXIMAGE2DPROC, "glTexImage2D")                                         \
  X(tex_sub_image_2d, PFNGLTEXSUBIMAGE2DPROC, "glTexSubImage2D")                               \
  X(tex_parameteri, PFNGLTEXPARAMETERIPROC, "glTexParameteri")                                 \
  X(uniform_1f, PFNGLUNIFORM1FPROC, "glUniform1f")                                             \
  X(uniform_1i, PFNGLUNIFORM1IPROC, "glUniform1i")                                             \
  X(uniform_1ui, PFNGLUNIFORM1UIPROC, "glUniform1ui")                                          \
  X(uniform_2fv, PFNGLUNIFORM2FVPROC, "glUniform2fv")                                          \
  X(uniform_3fv, PFNGLUNIFORM3FVPROC, "glUniform3fv")                                          \
  X(uniform_4fv, PFNGLUNIFORM4FVPROC, "glUniform4fv")                                          \
  X(uniform_matrix_3fv, PFNGLUNIFORMMATRIX3FVPROC, "glUniformMatrix3fv")                       \
  X(uniform_matrix_4fv, PFNGLUNIFORMMATRIX4FVPROC, "glUniformMatrix4fv")                       \
  X(use_program, PFNGLUSEPROGRAMPROC, "glUseProgram")                                          \
  X(vertex_attrib_pointer, PFNGLVERTEXATTRIBPOINTERPROC, "glVertexAttribPointer")              \
  X(viewport, PFNGLVIEWPORTPROC, "glViewport")

/// Entry points of one context.
struct GlFunctions {
#define PROMENADE_GL_MEMBER(member, type, name) type member = nullptr;
  PROMENADE_GL_FUNCTIONS(PROMENADE_GL_MEMBER)
#undef PROMENADE_GL_MEMBER
  PFNGLCLIPCONTROLPROC clip_control = nullptr;  ///< OpenGL 4.5 or GL_ARB_clip_control; null: not there
  bool anisotropic = false;                     ///< GL_EXT_texture_filter_anisotropic or its successors
};

using GlProc = void (*)();

/// Fills the table from the current context. Errors: the first function that is missing.
Result<GlFunctions> load_gl_functions(GlProc (*get_proc)(const char* name));

}  // namespace promenade
