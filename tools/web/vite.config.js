import { defineConfig } from 'vite';

export default defineConfig({
  base: './',
  build: {
    target: 'es2021',
    modulePreload: { polyfill: false },
    assetsInlineLimit: 0, // the page's content policy allows files of its own origin only
    emptyOutDir: true,
    reportCompressedSize: false,
    chunkSizeWarningLimit: 700, // kB: three; tests/web/size_test.mjs holds the bound
  },
  // `npm run dev` beside `npm run mock` or a daemon.
  server: { proxy: { '/api': process.env.LUXRIG_URL ?? 'http://127.0.0.1:9620' } },
});
