/** The page's colours for the room's picture, as style/theme.css has them. */

import {Color} from 'three';
import type {LampColours} from './fixtures_3d';
import type {PointColours} from './points_3d';

/** A colour of the style, its sRGB numbers kept as they are: the signs' shaders write them so. */
function colour(style: CSSStyleDeclaration, name: string): Color {
  const [r, g, b] =
      /^#(..)(..)(..)$/.exec(style.getPropertyValue(name).trim())?.slice(1).map((hex) => parseInt(hex, 16) / 255) ??
      [0.5, 0.5, 0.5];
  const made = new Color();
  [made.r, made.g, made.b] = [r!, g!, b!];
  return made;
}

export function readTheme(): {colours: PointColours; lamp: LampColours; ground: Color; line: Color} {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string): Color => colour(style, name);
  const dark = style.getPropertyValue('color-scheme').includes('dark');
  const over = of('--over');
  return {
    colours: {
      verdict: {
        met: of('--met'),
        low: of('--low'),
        high: of('--high'),
        over,
        'limit-unknown': over,
        unknown: of('--quiet'),
        none: of('--none')
      },
      halo: of('--halo'),
      text: of('--text'),
    },
    lamp: {lamp: of('--lamp'), halo: of('--halo'), track: of('--edge'), text: of('--text'), body: of('--quiet'), dark},
    ground: of('--raised'),
    line: of(dark ? '--ground' : '--quiet'),
  };
}

export function watchTheme(changed: () => void): void {
  new MutationObserver(changed).observe(document.documentElement, {attributes: true, attributeFilter: ['data-theme']});
  window.matchMedia('(prefers-color-scheme: light)').addEventListener('change', changed);
}

/** Whether pictures are computed by the processor. */
export function isSoftware(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  if (!context) return true;
  const named = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();  // browsers have few at a time
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
