#version 450
// Fragment stage: Lambert shading by every light, no shadows, gamma 2.2; the exact position; and the
// light before it is cut off at white and rounded, of which a camera takes what its exposure gives.

layout(constant_id = 0) const int NUM_DIRECTIONAL_LIGHTS = 0;
layout(constant_id = 1) const int NUM_POINT_LIGHTS = 0;

layout(set = 0, binding = 0) uniform CameraBuffer {
  mat4 viewMatrix;
  mat4 projectionMatrix;
  mat4 viewMatrixInverse;
  mat4 projectionMatrixInverse;
  float width;
  float height;
} cameraBuffer;

layout(set = 1, binding = 0) uniform ObjectTransformBuffer {
  mat4 modelMatrix;
} objectTransformBuffer;

layout(set = 1, binding = 1) uniform ObjectDataBuffer {
  uvec4 segmentation;
  float transparency;
  int shadeFlat;
} objectDataBuffer;

layout(set = 2, binding = 0) uniform MaterialBuffer {
  vec4 emission;
  vec4 baseColor;
  float fresnel;
  float roughness;
  float metallic;
  float transmission;
  float ior;
  float transmissionRoughness;
  int textureMask;
  int padding1;
  vec4 textureTransforms[6];
} materialBuffer;

layout(set = 2, binding = 1) uniform sampler2D colorTexture;
layout(set = 2, binding = 2) uniform sampler2D roughnessTexture;
layout(set = 2, binding = 3) uniform sampler2D normalTexture;
layout(set = 2, binding = 4) uniform sampler2D metallicTexture;
layout(set = 2, binding = 5) uniform sampler2D emissionTexture;

struct PointLight {
  vec4 position;
  vec4 emission;
};

struct DirectionalLight {
  vec4 direction;
  vec4 emission;
};

struct SpotLight {
  vec4 position;
  vec4 direction;
  vec4 emission;
};

layout(set = 3, binding = 0) uniform SceneBuffer {
  vec4 ambientLight;
  DirectionalLight directionalLights[3];
  SpotLight spotLights[10];
  PointLight pointLights[10];
  SpotLight texturedLights[1];
} sceneBuffer;

layout(location = 0) in vec4 inPosition;
layout(location = 1) in vec2 inUV;
layout(location = 2) in vec3 inNormal;

layout(location = 0) out vec4 outColor;
layout(location = 1) out vec4 outPosition;
layout(location = 2) out vec4 outRadiance;

const float PI = 3.14159265;

void main() {
  vec3 albedo = materialBuffer.baseColor.rgb;
  if ((materialBuffer.textureMask & 1) != 0) {
    albedo = texture(colorTexture, inUV).rgb;
  }
  vec3 normal = normalize(inNormal);
  normal = dot(normal, inPosition.xyz) > 0.0 ? -normal : normal;

  vec3 light = sceneBuffer.ambientLight.rgb;
  for (int i = 0; i < NUM_DIRECTIONAL_LIGHTS; ++i) {
    vec3 toward = -normalize(mat3(cameraBuffer.viewMatrix) * sceneBuffer.directionalLights[i].direction.xyz);
    light += sceneBuffer.directionalLights[i].emission.rgb * max(dot(normal, toward), 0.0) / PI;
  }
  for (int i = 0; i < NUM_POINT_LIGHTS; ++i) {
    vec3 lamp = (cameraBuffer.viewMatrix * vec4(sceneBuffer.pointLights[i].position.xyz, 1.0)).xyz;
    vec3 toward = lamp - inPosition.xyz;
    float square = max(dot(toward, toward), 1e-4);
    float facing = max(dot(normal, toward) * inversesqrt(square), 0.0);
    light += sceneBuffer.pointLights[i].emission.rgb * facing / (PI * square);
  }
  vec3 radiance = albedo * light + materialBuffer.emission.rgb;
  vec3 shade = clamp(radiance, 0.0, 1.0);
  outColor = vec4(pow(shade, vec3(1.0 / 2.2)), 1.0);
  // x follows from the depth, so its place tells which entity is seen; alpha must stay 1: blending
  outPosition = vec4(float(objectDataBuffer.segmentation.y), inPosition.yzw);
  outRadiance = vec4(radiance, 1.0);
}
