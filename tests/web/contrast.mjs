// Contrast of every visible text on the page (WCAG 2.2, success criterion 1.4.3: 4.5 : 1).

/** Texts whose contrast with their nearest opaque background is less than 4.5 : 1, each once, with the ratio. */
export function unreadableTexts(page) {
  return page.evaluate(() => {
    const parse = (css) => {
      const [r, g, b, a = 1] = css.match(/[\d.]+/g).map(Number);
      return { r, g, b, a };
    };
    const luminance = ({ r, g, b }) => {
      const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
      return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    };
    const groundOf = (element) => {
      for (let e = element; e; e = e.parentElement) {
        const color = parse(getComputedStyle(e).backgroundColor);
        if (color.a === 1) return color;
      }
      return { r: 255, g: 255, b: 255, a: 1 };
    };
    const found = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      // Text over the picture has a halo of the background's colour instead.
      if (!walker.currentNode.data.trim() || !element.checkVisibility({ checkVisibilityCSS: true }) || element.closest('svg.plan, .room-labels')) continue;
      const [text, ground] = [parse(getComputedStyle(element).color), groundOf(element)];
      const [light, dark] = [luminance(text), luminance(ground)].sort((a, b) => b - a);
      const contrast = (light + 0.05) / (dark + 0.05);
      if (contrast < 4.5) found.add(`${element.className || element.tagName}: ${contrast.toFixed(2)}`);
    }
    return [...found];
  });
}
